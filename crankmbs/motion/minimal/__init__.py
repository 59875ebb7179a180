"""The formulation `minimal`: angle and speed over time, piece by piece, also at rest and
backwards.

Its mechanics are scalars of its own (`reduced`, `stepper`); tables over the angle belong in
`crank_angle`.
"""
