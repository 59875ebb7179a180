"""Runs that several claims look at are made once."""

from functools import lru_cache

from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["run"]


@lru_cache(maxsize=32)
def run(scene: Scene, formulation: str | None = None) -> Result:
    """`simulate`, remembered; a run that does not reach its end is an error."""
    result = simulate(scene, formulation=formulation)
    if result.status != 0:
        raise RuntimeError(f"the run ended with status {result.status}: {result.message}")
    return result
