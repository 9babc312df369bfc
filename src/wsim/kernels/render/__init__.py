"""Kernels that draw glass, water and sky over an opaque ray-traced picture."""
