"""Many motions at once: the same machines under other loads, with other flywheels and starts.

A motion alone, and what is neither a settled motion nor a free run under plain loads, belongs in
simulate.
"""
