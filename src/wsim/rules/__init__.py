"""The planner that needs no model: grammar, lexicon, scenes composed from parts."""
