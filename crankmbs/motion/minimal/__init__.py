"""The formulation `minimal`: angle and speed over time, piece by piece, also at rest and
backwards.

SciPy takes the steps (`advance`), on polynomials over the crank angle (`reduced`); it shares the
mechanics with `crank_angle`, and no more.
"""
