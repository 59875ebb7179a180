"""What is true of an angle: closure of the loop, pressure, reduced inertia, loads, prescribed
speeds and the reactions that a motion makes.

Pure functions; nothing here is integrated in time.
"""
