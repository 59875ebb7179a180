"""Speed against error: every formulation, and on request its peers, against one reference."""

from crankmbs.work_precision.benchmark import TARGETS, WorkPrecision, work_precision
from crankmbs.work_precision.files import save_work_precision
from crankmbs.work_precision.rounds import Row
from crankmbs.work_precision.track import END, MOTION

__all__ = [
    "END",
    "MOTION",
    "TARGETS",
    "Row",
    "WorkPrecision",
    "save_work_precision",
    "work_precision",
]
