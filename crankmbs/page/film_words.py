"""What a film is about: one question of its run, and what to look at for the answer."""

from __future__ import annotations

from typing import NamedTuple

from crankmbs.result import Result
from crankmbs.result.event_words import marks
from crankmbs.scene.fuel import Governor
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import RPM

__all__ = ["Idea", "idea_of"]


class Idea(NamedTuple):
    """A question, and what to look at."""

    question: str
    sentence: str


_UNEVEN = Idea(
    "What does uneven firing do to the speed?",
    "Each firing burns another share of the fuel, the steps below the speed. Look at the crest "
    "that follows a firing: the larger its share, the higher the crest.",
)
_FIRES = Idea(
    "How does the fuel start and stop the engine?",
    "Where the share below the speed is one, each firing lifts the speed. Where it is zero, "
    "friction and load take it down, and compressed gas only gives back what it took.",
)
_STOPS = Idea(
    "Why does the crank stop where it does?",
    "Compressed gas gives its work back as it expands; friction gives nothing back. In the end "
    "the speed no longer carries a piston over its dead centre, and the gas throws the crank back "
    "until friction holds it.",
)
_SLOWS = Idea(
    "Why does the crank come to rest?",
    "Nothing gives back what loads and friction take. Look at how much speed each turn costs, and "
    "at the swing within a turn, by which crank, rods and pistons only exchange energy.",
)
_GATHERS = Idea(
    "Why does the speed not rise evenly from rest?",
    "A piston takes energy from the crank as it speeds up towards mid-stroke, and gives it back "
    "as it slows down towards a dead centre. Drag the cursor to a crest of the speed and see "
    "where the piston stands.",
)
_TURNS_BACK = Idea(
    "Where does the crank turn back?",
    "Below zero the crank turns the other way, and each piston retraces its stroke. Drag the "
    "cursor across a place where the speed passes zero.",
)
_MARKED = Idea(
    "How does the speed change from the first turn to the last?",
    "A dashed line says when something begins or ceases to act on the crank. Look at how the "
    "speed takes a new course there.",
)
_WHOLE = Idea(
    "How does the speed change from the first turn to the last?",
    "Drag the cursor to where the speed changes most and see where the pistons stand.",
)


def idea_of(result: Result, *, fuel_varies: bool) -> Idea:
    """The question of a run that is replayed.

    fuel_varies : whether the film has the share of the fuel below the speed

    >>> idea_of(simulate(load_scene("run_down")), fuel_varies=True).question
    'Why does the crank stop where it does?'
    """
    scene, words = result.scene, [mark.words for mark in marks(result)]
    rests = result.sampled("crank_speed")[-1] == 0.0
    governor = None if scene.fuel is None else scene.fuel.governor
    if fuel_varies and governor is not None and governor.kp + governor.ki > 0.0:
        return _governed(scene, governor)
    if rests and scene.start is not None:
        thrown = scene.gas is not None and scene.friction is not None and "reversal" in words
        return _STOPS if thrown else _SLOWS
    if "reversal" in words:
        return _TURNS_BACK
    if fuel_varies and scene.fuel is not None:
        return _UNEVEN if scene.fuel.misfire or scene.fuel.scatter > 0.0 else _FIRES
    if _starts_at_rest(scene) and scene.gas is None:
        return _GATHERS
    return _MARKED if words else _WHOLE


def _starts_at_rest(scene: Scene) -> bool:
    return scene.start is not None and scene.start.speed == 0.0


def _governed(scene: Scene, governor: Governor) -> Idea:
    cranked = (
        "Each compression slows the cranked engine, each expansion drives it. Once it fires, the"
    )
    begins = cranked if _starts_at_rest(scene) else "The"
    how = " and ".join(["is"] * (governor.kp > 0.0) + ["has been"] * (governor.ki > 0.0))
    near = " Play it slower to see the first turns: the plot zooms in." * _starts_at_rest(scene)
    return Idea(
        "How does the governor catch the engine?",
        f"{begins} governor sets the share of the fuel, the steps below, "
        f"by how far the mean speed {how} from {governor.speed / RPM:.6g} rpm.{near}",
    )
