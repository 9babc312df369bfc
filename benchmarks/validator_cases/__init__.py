"""What the static validator is measured with: correct programs, and mistakes planted in them.

    correct/NAME.py         a program that builds; it may have a `control`, too
    plans/NAME.json         its plan, if it has one
    mistakes/KIND.toml      mistakes of one kind: each a search and a replace in a correct program

`prove` runs them in the sandbox: that a correct program is correct, and that a mistake is one.
"""

from benchmarks.validator_cases.cases import FOLDER, Mistake, Program, halves, mistakes, programs

__all__ = ["FOLDER", "Mistake", "Program", "halves", "mistakes", "programs"]
