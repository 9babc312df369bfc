"""Geometry, with NumPy alone: rotations, the kinds of shape, solids, colour."""
