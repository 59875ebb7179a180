"""The page as one file: its modules, its style and its scene, and nothing from elsewhere."""

from __future__ import annotations

import base64
import dataclasses
import hashlib
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from crankmbs.design.freed import NEAR_REST, UNEVEN
from crankmbs.mechanics.variables import EVERY
from crankmbs.page.export import encoded, exported, rules
from crankmbs.page.film import film_of
from crankmbs.page.knobs import FIRING_ORDERS, Choice, choices_of, first_of, knobs_of, rated_part
from crankmbs.page.refusals import early_end, refusals, settling
from crankmbs.page.script import joined
from crankmbs.scene.force import PistonForce
from crankmbs.scene.forces import TravelTable
from crankmbs.scene.parts import LIGHT_CRANK
from crankmbs.scene.scene import Scene
from crankmbs.scene.sentences import RULES
from crankmbs.scene.whole import NO_INERTIA, OPEN_LOOP, UNCOVERED

__all__ = ["filled", "given_of", "page_of", "policy", "shown_scene"]

_FOLDER = Path(__file__).parent

_LABELLED = ("crank.inertia:", "flywheel:")  # of a key that a knob turns, its label
_NUMBERS = ("finite_number", "float_type", "greater_than_equal", "less_than_equal")
_ON = "run it with crankmbs run"
_ENDINGS = {
    "runs_away": "the loads take too little even at high speed",
    "decays": "the loads take too much even at low speed",
    "wanders": "the search for the motion that repeats itself finds none",
    "uneven": (
        "misfires make cycles differ, and the motion that repeats itself is one of several cycles: "
        "crankmbs run --until settled shows it"
    ),
    "light": NEAR_REST.replace(*_LABELLED),
    "slow": f"too light or too slow: the engine would stall; {_ON}",
    "held": f"a jump of the loads holds the speed from both sides; {_ON}",
}
_FOLD = f"fold: the rod folds onto the crank, where the motion is not determined; {_ON}"


def page_of(scene: Scene, stem: str) -> str:
    """A scene's page as HTML that needs no network: computed in the browser as its knobs turn, or,
    where the browser cannot run the scene, the run of `simulate`, replayed.

    Parameters
    ----------
    stem : name of the file of data that it hands out

    Raises
    ------
    InputError : a scene whose run cannot be replayed either, with the reasons

    >>> page_of(load_scene("propeller"), "mine").startswith("<!DOCTYPE html>")
    True
    """
    reasons = refusals(scene) or early_end(scene)
    if reasons:
        film = film_of(scene)
        return _rendered(
            "film", scene, stem, film.given, film=film, reason=reasons[0].partition(": ")[2]
        )
    shown = shown_scene(scene)
    choices = choices_of(shown)
    return _rendered(
        "page",
        scene,
        stem,
        _given(shown, stem, choices),
        prescribed=scene.motion is not None,
        uneven="" if scene.fuel is None else UNEVEN,
        choices={choice.name: choice for choice in choices},
        first=first_of(shown),
        rated=rated_part(shown),
        settles=shown.settles and not scene.settles,
    )


def _rendered(name: str, scene: Scene, stem: str, given: dict[str, Any], **words: Any) -> str:
    """A template filled in with a scene, with the module of its name and what that takes."""
    script = f"{joined(name)}.start();"
    style = (_FOLDER / "page.css").read_text(encoding="utf-8")
    words |= {"scene": scene, "stem": stem, "given": Markup(encoded(given))}
    words |= {"source": _sentence(scene.source)}
    return filled(_FOLDER / f"{name}.html", script, style, **words)


def _sentence(text: str | None) -> str:
    """A text with a full stop, so that another sentence can follow it."""
    text = (text or "").rstrip()
    return text if not text or text.endswith((".", "!", "?")) else f"{text}."


def filled(template: Path, script: str, style: str, *, fonts: bool = False, **words: Any) -> str:
    """A page from a template; fonts : whether the style brings some; words : what it shows."""
    environment = Environment(
        loader=FileSystemLoader(template.parent),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(template.name).render(
        policy=policy(script, style, fonts=fonts),
        script=Markup(script),
        style=Markup(style),
        **words,
    )


def shown_scene(scene: Scene) -> Scene:
    """The scene as the page runs it: settled, where it is free and can settle.

    >>> shown_scene(load_scene("propeller")).settles
    True
    """
    return settling(scene) or scene


def _given(scene: Scene, stem: str, choices: tuple[Choice, ...]) -> dict[str, Any]:
    """What the scripts take of a scene."""
    indicator = None if scene.gas is None else scene.gas.indicator
    return {
        **given_of(scene),
        "stem": stem,
        "knobs": [dataclasses.asdict(knob) for knob in knobs_of(scene)],
        "words": [{"name": choice.name, "words": choice.words} for choice in choices],
        "own": {choice.name: choice.value for choice in choices},
        "first": first_of(scene).knobs,
        "compression": None if indicator is None else indicator.compression_ratio,
        "units": {name: variable.units for name, variable in EVERY.items()},
    }


def given_of(scene: Scene) -> dict[str, Any]:
    """What the engine takes to run a scene as its knobs turn it, and to say what cannot be.

    >>> sorted(given_of(load_scene("propeller")))
    ['endings', 'orders', 'rules', 'scene', 'sentences', 'two_mass']
    """
    return {
        "scene": exported(scene),
        "rules": rules(),
        "two_mass": scene.rod.inertia == "two-mass",
        "orders": {name: list(order) for name, order in FIRING_ORDERS.items()},
        "endings": _ENDINGS,
        "sentences": {
            "open_loop": OPEN_LOOP,
            "light_crank": LIGHT_CRANK,
            "no_inertia": NO_INERTIA.replace(*_LABELLED),
            "uncovered": [_uncovered(*numbered) for numbered in enumerate(scene.force, start=1)],
            "fold": _FOLD,
            **{kind: RULES[kind] for kind in _NUMBERS},
        },
    }


def _uncovered(number: int, force: PistonForce) -> str | None:
    """What is said of a force over the travel whose rows do not cover it."""
    if not isinstance(force, TravelTable):
        return None
    return f"force[{number}].file: {force.file.source}: {UNCOVERED}"


def policy(script: str, style: str, *, fonts: bool = False) -> str:
    """A content-security policy under which nothing else runs, and nothing is fetched.

    fonts : whether the style brings fonts with it

    >>> "font-src" in policy("", "")
    False
    """
    return (
        f"default-src 'none'; script-src {_hash(script)}; style-src {_hash(style)}; "
        f"{'font-src data:; ' if fonts else ''}base-uri 'none'; form-action 'none'"
    )


def _hash(text: str) -> str:
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
