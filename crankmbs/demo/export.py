"""Files that the page hands out: the scene that it shows, and its data."""

from __future__ import annotations

import base64
import io
import tempfile
import zipfile
from pathlib import Path

from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.scene.write import scene_files

__all__ = ["data_file", "download", "scene_file"]

Download = dict[str, list[str]]


def scene_file(scene: Scene, stem: str) -> tuple[str, bytes]:
    """Name and content: STEM.toml, or STEM.zip with the tables beside it where it has some."""
    files = scene_files(scene, stem)
    if len(files) == 1:
        ((name, text),) = files.items()
        return name, text.encode()
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(zipfile.ZipInfo(name), text, zipfile.ZIP_DEFLATED)
    return f"{stem}.zip", packed.getvalue()


def data_file(result: Result, stem: str) -> tuple[str, bytes]:
    """Name and content of the result's motion.csv."""
    with tempfile.TemporaryDirectory() as folder:
        result.save(folder)
        return f"{stem}.csv", Path(folder, "motion.csv").read_bytes()


def download(name: str, content: bytes) -> Download:
    """Columns of the source from which the browser saves a file."""
    return {"name": [name], "base64": [base64.b64encode(content).decode()]}
