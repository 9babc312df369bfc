"""Checks: what holds for any world, and what a plan adds; a check is a class, and `listed` has them all."""
