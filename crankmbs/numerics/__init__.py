"""Numerical methods that know nothing of cranks: roots, Gauss collocation, periods of angles,
compiled loops.

Nothing here imports anything of crankmbs; mechanics belongs elsewhere.
"""
