"""A scene and its result for other programs: TOML, MATLAB, and exudyn as a script of its own."""

from crankmbs.export.files import export

__all__ = ["export"]
