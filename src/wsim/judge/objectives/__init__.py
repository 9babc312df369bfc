"""Objectives: what a plan says must happen, a class for each kind."""
