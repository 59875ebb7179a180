"""Scenes as `validation.random_scenes` draws them, by hypothesis: what breaks a law shrinks to the
plainest machine that does."""

from typing import Any

import numpy as np
from hypothesis import strategies as st

from validation.random_scenes import _Draw

_STEPS = 10**6


class _Numbers:
    """What the scenes take of a generator of NumPy."""

    def __init__(self, draw):
        self._draw = draw

    def random(self):
        return self.uniform(0.0, 1.0)

    def uniform(self, low, high, size=None):
        """In a million steps: none is as good as another, or as zero; several are unlike."""
        step = st.integers(0, _STEPS)
        if size is not None:
            step = st.lists(step, min_size=size, max_size=size, unique=True).map(np.array)
        return low + (high - low) * (self._draw(step) / _STEPS)

    def integers(self, low, high):
        return self._draw(st.integers(low, high - 1))

    def permutation(self, count):
        return np.array(self._draw(st.permutations(range(count))))

    def choice(self, count, size=None, *, replace=True, p=None):
        """One by its weight, of which only zero counts here; or several unlike ones."""
        if size is None:
            return self._draw(st.sampled_from(np.flatnonzero(p).tolist()))
        assert not replace
        return self._draw(st.permutations(range(count)))[:size]


class _Drawn(_Draw):
    def __init__(self, draw):
        self._rng: Any = _Numbers(draw)


@st.composite
def scenes(draw):
    """Valid scenes of a free crank."""
    return _Drawn(draw).scene()
