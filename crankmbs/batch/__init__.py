"""Many motions at once: the same machines under other loads, with other flywheels and starts.

A motion alone, and all that is neither settled nor a free run under plain loads, belongs in
simulate.
"""
