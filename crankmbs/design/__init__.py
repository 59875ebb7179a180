"""What a machine should have, found from its runs: counterweights for a share of its moving mass.

What a given machine does belongs in measures; how it differs from others in compare.
"""

from crankmbs.design.balance import Balance, Remaining, balance

__all__ = ["Balance", "Remaining", "balance"]
