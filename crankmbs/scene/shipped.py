"""The scenes that ship with the package."""

from __future__ import annotations

from pathlib import Path

__all__ = ["models_folder", "shipped_scenes"]


def models_folder() -> Path:
    """The folder of the shipped scenes: in the installed package, or beside it in a checkout."""
    package = Path(__file__).parent.parent
    installed = package / "_models"
    return installed if installed.is_dir() else package.parent / "models"


def shipped_scenes() -> dict[str, Path]:
    """Names of the shipped scenes and their files, sorted."""
    return {path.stem: path for path in sorted(models_folder().glob("*.toml"))}
