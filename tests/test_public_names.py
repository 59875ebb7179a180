"""The public names: what is importable from crankmbs is what __all__ says, and documented."""

import inspect
import types

import pytest

import crankmbs


def public():
    return {
        name
        for name, value in vars(crankmbs).items()
        if not name.startswith("_") and not isinstance(value, types.ModuleType)
    }


def test_all_is_exactly_what_is_public():
    assert set(crankmbs.__all__) == public()
    assert list(crankmbs.__all__) == sorted(crankmbs.__all__)


@pytest.mark.parametrize("name", crankmbs.__all__)
def test_a_public_name_has_a_docstring_of_its_own(name):
    assert inspect.getdoc(getattr(crankmbs, name))
