"""The roles that use a language model: planner, coder, reviewer, judge.

Each has a context of its own and hands over artefacts only: a plan, a patch, a review, an opinion. Everything that is
asked and answered goes through `wsim.agents.relay`, which writes it down, and can answer from what was written.
"""
