"""Rigid motions with a known answer, one file a family."""
