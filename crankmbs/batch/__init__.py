"""Many motions at once: the same machines under other loads, with other flywheels and starts.

A motion alone, and all that is no settled motion or free run under plain loads, belongs in simulate.
"""
