"""Commands of the tests, called as from a terminal, and the scene that they are given."""

import importlib
import json
from pathlib import Path

from typer.testing import CliRunner

from crankmbs.cli import app
from crankmbs.scene.shipped import models_folder

RUNNING = importlib.import_module("crankmbs.simulate")  # the package names its function so
PRESSURE = models_folder() / "pressure" / "made_up_diesel.csv"
SCENE = f"""
title = "driven [red] engine"

[crank]
radius = "46 mm"
inertia = "0.02 kg m^2"

[rod]
length = "153 mm"
mass = "1.4 kg"
center_of_mass = "43 mm"
inertia = "two-mass"

[piston]
mass = "1.1 kg"
bore = "85 mm"

[gas]
pressure = {json.dumps(str(PRESSURE))}
absolute = false

[motion]
speed = "3000 rpm"

[run]
until = "2 cycles"
"""


def crankmbs_(*words):
    return CliRunner().invoke(app, list(words))


def refused(*words):
    """The one message of a command that must be refused."""
    result = crankmbs_(*words)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    (message,) = result.stderr.strip().splitlines()
    assert message.startswith("error: ")
    return message.removeprefix("error: ")


def names(path):
    return {file.name for file in Path(path).iterdir()}
