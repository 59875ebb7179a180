"""Crank trains as bodies of MuJoCo, turned by its own mass matrix, bias forces and Jacobians."""
