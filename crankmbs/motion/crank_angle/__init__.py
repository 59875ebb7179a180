"""The formulation `crank_angle`: energy over the crank angle, in cells between the knots of the
pressure.

Time as the variable belongs in `minimal`, the change between the two in `free`.
"""
