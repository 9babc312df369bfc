"""Thin classes that validate and launch kernels."""
