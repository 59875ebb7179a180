"""A scene and its result for other programs: TOML, MATLAB, and exudyn as a script."""

from crankmbs.export.files import copy_scene, export

__all__ = ["copy_scene", "export"]
