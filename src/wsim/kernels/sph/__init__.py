"""Weakly compressible smoothed particle hydrodynamics.

All particles, fluid and boundary, stand in one list sorted by grid cell. Two 16-byte records hold what a pair needs:
`point` = (x, y, z, V) and `motion` = (vx, vy, vz, p). V is the volume; a boundary particle's is negative, so that a
sum knows what it meets without another load.
"""
