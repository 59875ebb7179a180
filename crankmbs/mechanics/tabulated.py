"""Another name of `crankmbs.mechanics.inertia.reduce`."""

from crankmbs.mechanics.inertia import reduce as tabulate

__all__ = ["tabulate"]
