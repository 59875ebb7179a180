"""A motion in steps over time that someone else asks for: free by `minimal`, in two passes side by
side, or prescribed, by algebra.

A step ends at a time, may be shorter than a degree and begin at rest, and nobody knows what follows
it. So the crank angle is no variable for it, whole segments are not solved, and nothing is refined
afterwards: both passes are carried along, and what they differ by is what the motion errs.
"""
