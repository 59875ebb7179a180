"""What the events of a run are called in figures."""

from __future__ import annotations

import numpy as np

from crankmbs.result.record import Result

__all__ = ["event_words"]


def event_words(result: Result) -> list[str]:
    """What stands beside each event; nothing at decisions on the fuel but the first that fires of a
    fuel that is waited for and the first that does not after it is cut.

    >>> event_words(simulate(load_scene("run_up").with_(run__until="0.1 s")))[0]
    'speed table on'
    """
    kinds, loads, shares = map(result.event_table.values, ("kind", "load", "share"))
    scene, fired_from, cut = result.scene, False, False
    if scene.fuel is not None:
        fired_from = scene.fuel.after > 0.0 or scene.fuel.from_speed is not None
        cut = scene.fuel.until is not None or scene.fuel.until_speed is not None
    names = [load.called for load in scene.torque]
    names = [f"{name} {k}" if names.count(name) > 1 else name for k, name in enumerate(names, 1)]
    words = [
        f"{names[load - 1]} {kind.removeprefix('load ')}" if load else kind
        for kind, load in zip(kinds.tolist(), loads.tolist(), strict=True)
    ]
    fuel = np.flatnonzero(kinds == "fuel")
    fired = fuel[shares[fuel] > 0.0]
    for k in fuel.tolist():
        words[k] = ""
    if fired_from and len(fired):
        words[fired[0]] = "first firing"
    if cut and len(fired) and fired[-1] < fuel[-1]:
        words[fuel[fuel > fired[-1]][0]] = "fuel cut"
    return words
