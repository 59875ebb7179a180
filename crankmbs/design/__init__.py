"""What to build so that a run gives what is wanted: a flywheel for a fluctuation of speed.

What a given machine does belongs in measures; what a lecture would answer in lecture.
"""
