"""Weakly compressible smoothed particle hydrodynamics.

All particles, fluid and boundary, stand in one list sorted by grid cell. Two 16-byte records hold what a pair needs:
`point` = (x, y, z, p/rho^2) and `motion` = (vx, vy, vz, rho); `mass` and `kind` stand beside them.
"""
