"""Figures of a result, drawn with matplotlib and without its global state.

`plot` draws one of a result's figures by its kind, which is what ``result.plot(kind)`` gives; the
functions below draw each from a `last_view`, its last cycle with angles in degrees. All return a
matplotlib figure, to be changed and saved as any other:

>>> figure = simulate(load_scene("propeller")).plot("polar")
>>> _ = figure.axes[0].set_title("my crank pin")

What is drawn is computed elsewhere: in measures, compare and mechanics; here are axes and labels.
"""

import lazy_loader as _lazy_loader

__getattr__, __dir__, __all__ = _lazy_loader.attach_stub(__name__, __file__)
