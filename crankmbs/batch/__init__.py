"""Many motions at once: of machines under other loads, with other flywheels, starts and lengths.

A motion alone, and all that is neither settled nor a free run under plain loads, belongs in
simulate.
"""
