"""The multibody model of a scene as a script of its own, which needs numpy and exudyn alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crankmbs.errors import InputError
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.motion.multibody.single import Single, single_run
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import NEAR
from crankmbs.scene.loads import Constant, Quadratic, Viscous
from crankmbs.scene.scene import Scene

__all__ = ["exudyn_script"]

_BODY = Path(__file__).with_name("exudyn_body.txt")
_STATED = {  # variable -> its words in the head of the script; a prescribed motion errs in forces
    "crank_angle": "crank angle [rad]",
    "crank_speed": "crank speed [rad/s]",
    "main_bearing_force_x": "main bearing force, x [N]",
    "main_bearing_force_y": "main bearing force, y [N]",
    "crank_pin_force_x": "crank pin force, x [N]",
    "crank_pin_force_y": "crank pin force, y [N]",
    "side_force": "side force [N]",
}


def exudyn_script(scene: Scene, stem: str) -> str:
    """A script that builds the bodies, joints and loads of a scene and runs them in exudyn.

    It gives the run of `crankmbs.motion.multibody` at its step, not extrapolated; how far that is
    from the motion it says in its head. Run, it writes STEM.csv.

    Raises
    ------
    InputError : fuel, friction, loads with windows, tables or functions, a speed that changes, a
        settled motion, forces that jump; says which

    >>> "def run():" in exudyn_script(load_scene("torque_driven"), "mine")
    True
    """
    refused = _refused(scene)
    if refused:
        raise InputError(f"a script for exudyn cannot express {refused}")
    train = crank_train(scene)
    try:
        found = single_run(train)
    except InputError as error:
        raise InputError(f"a script for exudyn cannot express this scene: {error}") from None
    head = _head(scene, found)
    parameters = _parameters(scene, found, stem)
    main = 'if __name__ == "__main__":\n    main()\n'
    return "\n".join([head, parameters, _BODY.read_text(encoding="utf-8"), *_gas(train), main])


def _refused(scene: Scene) -> str:
    """What in a scene a script does not express, and the way out."""
    if scene.settles:
        return 'until = "settled", which is solved for and not run to; give an end such as "2 rev"'
    if scene.fuel is not None:
        return "[fuel], whose shares are decided on the way; remove [fuel]"
    if scene.friction is not None:
        return "[friction], which jumps where a piston turns; remove [friction]"
    if scene.motion is not None and not isinstance(scene.motion.speed, float):
        return "a prescribed speed that changes; give one constant speed, or free the crank"
    for number, load in enumerate(scene.torque, start=1):
        if not isinstance(load, Constant | Viscous | Quadratic):
            kind = "a function of Python" if load.parts.function else f"a {load.kind}"
            return (
                f"torque[{number}], {kind}; give constant, viscous or quadratic loads, which are "
                "smooth"
            )
        if load.has_window:
            return f"the window of torque[{number}]; leave out when it sets in and ends"
    return ""


def _head(scene: Scene, found: Single) -> str:
    stated = _STATED if scene.motion is None else dict(list(_STATED.items())[2:])
    title = " ".join(scene.title.split()) or "a scene"
    lines = [
        f"# {title.encode('ascii', 'replace').decode()}",
        "#",
        "# A slider-crank mechanism of rigid bodies in exudyn, written by crankmbs.",
        "# Planar: X along the cylinder from the crank axis to the head, Y is X turned by +90",
        "# degrees. Units are SI. It needs numpy and exudyn.",
        "#",
        f"# At this step ({found.step:.6g} s) it differs from the motion by at most about",
        *(f"#     {found.errors[name]:<10.1e} {words}" for name, words in stated.items()),
        "",
        "import math",
        "from bisect import bisect_right",
        "",
        "import exudyn as exu",
        "import exudyn.itemInterface as eii",
        "import numpy as np",
    ]
    return "\n".join(lines)


def _parameters(scene: Scene, found: Single, stem: str) -> str:
    crank, rod, g = scene.crank, scene.rod, scene.gravity
    pull = (0.0, 0.0)
    if g is not None:
        direction = g.acceleration * np.exp(1j * g.angle)
        pull = (float(direction.real), float(direction.imag))
    begin = scene.start or scene.motion
    assert begin is not None
    speed = None if scene.motion is None else scene.motion.speed
    values: list[tuple[str, object, str]] = [
        ("CRANK_RADIUS", crank.radius, "m"),
        ("CRANK_INERTIA", crank.moment_of_inertia, "kg m^2, about its axis, flywheel included"),
        ("CRANK_MASS", crank.mass, "kg"),
        ("CRANK_CENTER", crank.center_of_mass, "m, centre of mass along the reference line"),
        ("ROD_LENGTH", rod.length, "m"),
        ("ROD_MASS", rod.mass, "kg"),
        ("ROD_CENTER", rod.center_of_mass, "m, centre of mass from the crank pin"),
        ("ROD_INERTIA", rod.moment_of_inertia, "kg m^2, about the centre of mass"),
        ("PISTON_MASS", scene.piston.mass, "kg"),
        ("PISTON_OFFSET", scene.piston.offset, "m, of the cylinder axis in +Y"),
        ("PHASES", [c.phase for c in scene.cylinders], "rad, cycle angles at crank angle 0"),
        ("BANKS", [c.bank for c in scene.cylinders], "rad, of the cylinders from the engine's X"),
        ("GRAVITY", pull, "m/s^2"),
        ("TORQUE_CONSTANT", _sum(scene, Constant, "torque"), "N m, on the free crank"),
        ("TORQUE_VISCOUS", 0.0 - _sum(scene, Viscous, "coefficient"), "N m s"),
        ("TORQUE_QUADRATIC", 0.0 - _sum(scene, Quadratic, "coefficient"), "N m s^2"),
        ("PRESCRIBED_SPEED", speed, "rad/s; None: the crank is free"),
        ("START_ANGLE", begin.angle, "rad"),
        ("OUTPUT", f"{stem}.csv", ""),
        ("NEAR", NEAR, "rad: angles nearer than this are one"),
        ("", "", ""),
        (
            "",
            "",
            "The step, and where the run-up begins that ends at the scene's start: values for",
        ),
        ("", "", "this step and these parameters from which the joint forces do not ring."),
        ("STEP", found.step, "s"),
        ("RUN_UP", found.run_up, "steps before the start"),
        ("STEPS", found.steps, "in all"),
    ]
    if speed is not None:
        values.append(("RUN_UP_ANGLES", list(found.angles), "rad"))
    lines = [_line(*value) for value in values]
    arrays = {
        "REFERENCE": found.reference,
        "START_POSITION": found.start.position,
        "START_VELOCITY": found.start.velocity,
        "START_ACCELERATION": found.start.acceleration,
    }
    about = "# x, y [m], angle [rad] of the crank, then of each rod and x, y of its piston:"
    return "\n".join(["", *lines, about, *(_array(*each) for each in arrays.items())])


def _line(name: str, value: object, about: str) -> str:
    if not name:
        return f"# {about}" if about else ""
    return f"{name} = {value!r}" + (f"  # {about}" if about else "")


def _sum(scene: Scene, kind: type, name: str) -> float:
    return math.fsum(getattr(load, name) for load in scene.torque if isinstance(load, kind))


def _array(name: str, values: Array) -> str:
    return f"{name} = np.array([\n{_rows(values.tolist())}])"


def _rows(values: Sequence[float], across: int = 3) -> str:
    rows = (values[k : k + across] for k in range(0, len(values), across))
    return "".join(f"    {', '.join(map(repr, row))},\n" for row in rows)


def _gas(train: CrankTrain) -> list[str]:
    """The forces of the gas: each different pressure once, and which each cylinder has."""
    area = train.scene.piston.gas_area or 0.0
    pressures = list(train.pressure or ())
    different = list(dict.fromkeys(pressures))
    lines = [
        "# What the gas puts on a piston [N] over its cycle angle [rad]: from each start a cubic,",
        "# by descending power of the angle from there.",
    ]
    for number, pressure in enumerate(different, start=1):
        knots = pressure.knots
        cubics = (area * pressure.coefficients).T
        lines += [
            f"PIECES_{number} = {{",
            f'    "first": {float(knots[0]) - NEAR!r},',
            f'    "period": {float(knots[-1] - knots[0])!r},',
            '    "starts": [',
            _rows((knots[:-1] - knots[0]).tolist(), 4).rstrip(),
            "    ],",
            '    "cubics": [',
            *(f"    ({', '.join(map(repr, row))})," for row in cubics.tolist()),
            "    ],",
            "}",
        ]
    names = [f"PIECES_{different.index(pressure) + 1}" for pressure in pressures]
    return [*lines, f"GAS = [{', '.join(names)}]", "", ""]
