"""Many settled motions at once: the same machines under other loads and with other flywheels.

A motion alone, and all that is no periodic motion under plain loads, belongs in simulate.
"""
