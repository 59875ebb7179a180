"""Speed against error: every formulation, and what is put beside them, against one reference.

Other tools and limits live with the evidence, in validation/speed.
"""

from crankmbs.work_precision.benchmark import (
    TARGETS,
    Beside,
    WorkPrecision,
    work_precision,
)
from crankmbs.work_precision.files import save_work_precision
from crankmbs.work_precision.rounds import Row
from crankmbs.work_precision.trace import END, MOTION

__all__ = [
    "END",
    "MOTION",
    "TARGETS",
    "Beside",
    "Row",
    "WorkPrecision",
    "save_work_precision",
    "work_precision",
]
