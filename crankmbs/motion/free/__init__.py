"""A free motion from start to end: two passes, handed over between `crank_angle` and `minimal`,
and matched.

The only place that knows both; how either takes a step belongs to them.
"""
