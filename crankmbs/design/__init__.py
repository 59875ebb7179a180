"""What to build so that a run gives what is wanted: counterweights, a flywheel, a balanced load.

What a given machine does belongs in measures; how it differs from others in compare.
"""

from crankmbs.design.balance import Balance, Remaining, balance
from crankmbs.design.flywheel import Flywheel, flywheel
from crankmbs.design.freed import freed

__all__ = ["Balance", "Flywheel", "Remaining", "balance", "flywheel", "freed"]
