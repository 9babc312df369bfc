"""The books of every body: what changed its momentum, and whether the world has forces that could."""
