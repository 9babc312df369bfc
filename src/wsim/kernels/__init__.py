"""Warp kernels and functions, nothing else: no classes, no I/O, no Newton model."""
