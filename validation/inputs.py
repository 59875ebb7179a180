"""What a claim is judged from, as a digest that its row in `results.csv` keeps."""

from __future__ import annotations

import re
from collections.abc import Iterable
from hashlib import sha256
from pathlib import Path

from validation import reference
from validation.case import CASES, Case

__all__ = ["digest", "inputs", "short_hash"]

_HERE = Path(__file__).parent
_MODULE = re.compile(r"^from validation\.(checks\.\w+|random_\w+) import ", re.MULTILINE)
_READS = re.compile(r"^from validation import .*\breference\b", re.MULTILINE)
_STORED = re.compile(r"^from validation\.(\w+)\.stored import ", re.MULTILINE)
_TABLE = re.compile(r'"([^"]+\.csv)"')


def digest(case: Case) -> str:
    """Twelve hexadecimal digits of the files that say what is claimed and what it is held against.

    These are the case, its scene with the tables that it names, the module of its check with the
    checks and the random scenes that this imports, all reference tables where one of them reads
    any, and the stored numbers of another program where one reads these. A row with another digest
    was measured for another claim.

    The code of crankmbs and of the oracles is left out: nearly every commit changes it, and to
    judge all claims takes hours. Continuous integration judges the quick claims by the code
    as it is, tests hold the oracles, and every row names the commit that it was measured at.
    """
    return short_hash(_text(path) for path in inputs(case))


def inputs(case: Case) -> list[Path]:
    """The files of a claim, its case first."""
    modules = _with_imports([_HERE / "checks" / f"{case.check.partition('.')[0]}.py"])
    files = [CASES / f"{case.name}.toml", *modules]
    if case.scene:
        scene = case.scene_file()
        files += [scene, *(scene.parent / table for table in _TABLE.findall(_text(scene)))]
    if any(_READS.search(_text(module)) for module in modules):
        files += sorted(reference.FOLDER.glob("*.csv"))
    for folder in dict.fromkeys(name for m in modules for name in _STORED.findall(_text(m))):
        files += sorted((_HERE / folder).glob("*.csv"))
    return files


def short_hash(parts: Iterable[str]) -> str:
    """Twelve hexadecimal digits of texts, each ended by a zero."""
    whole = sha256()
    for part in parts:
        whole.update(part.encode() + b"\0")
    return whole.hexdigest()[:12]


def _with_imports(modules: list[Path]) -> list[Path]:
    """Modules and what they import of checks and random scenes, each once."""
    for module in modules:  # grows while it is walked
        found = (_HERE / f"{name.replace('.', '/')}.py" for name in _MODULE.findall(_text(module)))
        modules += [path for path in dict.fromkeys(found) if path not in modules]
    return modules


def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")
