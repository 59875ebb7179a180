"""Numerical methods that know nothing of cranks: roots, Gauss collocation, periods of angles.

Nothing here imports anything of crankmbs; mechanics belongs elsewhere.
"""
