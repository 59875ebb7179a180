"""Crank, rods and pistons as rigid bodies on joints, in exudyn: the independent check.

Every body has its own coordinates, every joint its multipliers: motion and reactions are exudyn's.
With the others it shares what is given to it, pressure, loads and prescribed speed, and the loop
closure, from which positions that meet exudyn's constraints are sought.
"""
