"""Programs with one wrong number each, and what becomes of them when the judge's suggestions are applied."""
