"""Axes that say quickly how much room is needed around them."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.legend import Legend
from matplotlib.text import Text
from matplotlib.transforms import Bbox

__all__ = ["Panel"]

_AWAY = 5.5  # points: from a panel to its numbers, from these to the label


class Panel(Axes):
    """Axes in a figure whose labels stand beyond the longest number of all its panels.

    Of the numbers of an axis that one is measured: matplotlib measures all of them, several times,
    which takes as long as to draw them.
    """

    def get_tightbbox(self, *_: Any, **__: Any) -> Bbox:
        """The panel with what is written around it [pixels]; labels of axes may be longer."""
        self.apply_aspect()
        panel, low = self.bbox, _numbers(self.xaxis)
        across = max(_numbers(ax.yaxis).width for ax in self.figure.axes)
        self.xaxis.set_label_coords(0.5, -low.height / panel.height)
        self.yaxis.set_label_coords(-across / panel.width, 0.5)
        written = [
            each.get_window_extent()
            for each in self.get_children()
            if isinstance(each, Text | Legend)
        ]
        edge = panel.padded(0.5 * low.width, 0.2 * _numbers(self.yaxis).height)  # half a number
        whole = Bbox.union([edge, *(box for box in written if box.width)])
        return Bbox.from_extents(
            self.yaxis.label.get_window_extent().x0,
            min(whole.y0, self.xaxis.label.get_window_extent().y0),
            whole.x1,
            whole.y1,
        )


def _numbers(axis: Axis) -> Bbox:
    """The longest number of an axis with the room beside it [pixels]."""
    words = axis.get_majorticklabels() if axis.axes.axison else []
    longest = max(words, key=lambda word: len(word.get_text()), default=axis.label)
    return longest.get_window_extent().padded(_AWAY * axis.figure.dpi / 72.0 * bool(words))
