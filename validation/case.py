"""A claim: one TOML file that says what is claimed, how close, why, and how to break it."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from crankmbs.scene.drives import Motion, Start
from crankmbs.scene.read import load_scene, scene_path
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene

__all__ = ["CASES", "Case", "Mutant", "driven", "load_case", "load_cases", "shifted"]

CASES = Path(__file__).parent / "cases"
_SCENES = Path(__file__).parent / "scenes"


@dataclass(frozen=True)
class Mutant:
    """One parameter of our side, and the factor that must turn the claim red.

    parameter : "parameters.rod_ratio", or a path in the scene such as "rod.length"
    until : shortens the run [s] where a whole one is not needed to see it fail
    """

    parameter: str
    factor: float
    until: float | None = None


@dataclass(frozen=True, kw_only=True)
class Case:
    """The fields of a case file; `name` is the file's.

    mutated : whether the mutant is applied to our side; shortened : whether the run ends at its
    `until`, on both sides

    check : "module.function" in validation.checks
    scene : a file in validation/scenes or a shipped scene; change : paths in it and new values
    drive : "constant" prescribes the speed of a free scene, "free" frees a prescribed one
    until : shortens the run [cycles]
    standing : of published numbers, whether the claim predicts them or, where parameters were
        identified from the source, is consistent with them
    """

    name: str
    claim: str
    check: str
    quantity: str
    norm: str
    tolerance: float
    reason: str
    source: str
    mutant: Mutant
    standing: str = ""
    quick: bool = True
    scene: str = ""
    drive: str = "as shipped"
    until: float | None = None
    change: Mapping[str, Any]
    parameters: Mapping[str, Any]
    mutated: bool = False
    shortened: bool = False

    def scene_file(self) -> Path:
        """The file of the scene."""
        path = _SCENES / f"{self.scene}.toml"
        return path if path.is_file() else scene_path(self.scene)

    def theirs(self) -> Scene:
        """The scene that the reference is taken for."""
        scene = load_scene(self.scene_file())
        for key, value in self.change.items():
            scene = shifted(scene, key, lambda _, value=value: value)
        if self.until is not None:
            scene = replace(scene, run=replace(scene.run, until=_cycles(self.until)))
        if self.shortened and self.mutant.until is not None:
            until = Extent(value=self.mutant.until, unit="s")
            scene = replace(scene, run=replace(scene.run, until=until))
        return driven(scene, self.drive)

    def ours(self) -> Scene:
        """The scene that is simulated: theirs, but for the mutant."""
        scene, key = self.theirs(), self.mutant.parameter
        if not self.mutated or key.startswith("parameters."):
            return scene
        mutant: Scene = shifted(scene, key, lambda value: value * self.mutant.factor)
        return mutant

    def number(self, name: str) -> float:
        """A numeric parameter of our side."""
        factor = self.mutant.factor if self.mutated else 1.0
        shift = factor if self.mutant.parameter == f"parameters.{name}" else 1.0
        return float(self.parameters[name]) * shift

    def mutated_value(self) -> float:
        """The value that the mutant is applied to, in SI units."""
        of_check, _, name = self.mutant.parameter.partition(".")
        if of_check == "parameters":
            return float(self.parameters[name])
        part: Any = self.theirs()
        for name in self.mutant.parameter.split("."):
            part = part[int(name)] if isinstance(part, tuple) else getattr(part, name)
        return float(part)

    def word(self, name: str) -> str:
        """A parameter that is a name."""
        return str(self.parameters[name])


def load_case(path: Path) -> Case:
    """Read one case file; an unknown or a missing key raises TypeError."""
    with path.open("rb") as file:
        raw = tomllib.load(file)
    mutant = Mutant(**raw.pop("mutant"))
    change, parameters = raw.pop("change", {}), raw.pop("parameters", {})
    return Case(name=path.stem, mutant=mutant, change=change, parameters=parameters, **raw)


def load_cases() -> list[Case]:
    """Every claim, in the order of the file names."""
    return [load_case(path) for path in sorted(CASES.glob("*.toml"))]


def shifted(part: Any, path: str, new: Any) -> Any:
    """A copy of a scene (or a part of it) with `new(old value)` at a dotted path."""
    name, _, rest = path.partition(".")
    if isinstance(part, tuple):
        k = int(name)
        return (*part[:k], shifted(part[k], rest, new), *part[k + 1 :])
    old = getattr(part, name)
    return replace(part, **{name: shifted(old, rest, new) if rest else new(old)})


def _cycles(number: float) -> Extent:
    return Extent(value=number, unit="cycle")


def driven(scene: Scene, drive: str) -> Scene:
    """The same machine with its speed prescribed, or freed from the same state."""
    if drive == "constant":
        assert scene.start is not None
        motion = Motion(speed=scene.start.speed, angle=scene.start.angle)
        return replace(scene, start=None, torque=(), motion=motion)
    if drive == "free":
        assert scene.motion is not None
        speed = scene.motion.speed
        at_start = speed if isinstance(speed, float) else speed.mean  # type: ignore[union-attr]
        return replace(scene, motion=None, start=Start(angle=scene.motion.angle, speed=at_start))
    return scene
