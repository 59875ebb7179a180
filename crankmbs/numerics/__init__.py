"""Numerical methods that know nothing of cranks: roots, Gauss collocation, periods of angles, and
whether loops are compiled.

Nothing here imports anything of crankmbs; mechanics belongs elsewhere.
"""
