"""What a lesson's figure draws and says, read from its answer, and when numbers agree."""

import re

import numpy as np


def same(found, wanted, near=1e-9):
    """Whether numbers agree, to a share of the largest of them."""
    found, wanted = np.asarray(found, dtype=float), np.asarray(wanted, dtype=float)
    if found.shape != wanted.shape:
        return False
    return bool(np.all(np.abs(found - wanted) <= near * max(np.abs(wanted).max(), 1e-12)))


def said(figure, what, wanted):
    """Whether the first number of a text is a value, to its last digit."""
    text = re.search(r"[-\u2212]?[\d.]+", figure["says"][what])[0].replace("\u2212", "-")
    last = 10.0 ** -len(text.partition(".")[2])
    return abs(float(text) - wanted) <= 0.5001 * last + 2e-9 * abs(wanted)


def column(figure, name):
    return np.array([v[name] for v in figure["samples"]])


def of_first(figure, name):
    return np.array([v["cylinders"][0][name] for v in figure["samples"]])


def y(figure, curve, shape=0):
    return np.array(figure["shapes"][shape]["curves"][curve]["y"], dtype=float)


def x(figure, curve, shape=0):
    return np.array(figure["shapes"][shape]["curves"][curve]["x"], dtype=float)


def gear(figure):
    scene = figure["scene"]
    r, l = scene["crank"]["radius"], scene["rod"]["length"]
    return r, l, r / l
