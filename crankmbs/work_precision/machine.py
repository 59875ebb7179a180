"""The machine and the versions a measurement was made with."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

__all__ = ["about_machine"]

_PACKAGES = ("crankmbs", "numpy", "scipy", "numba", "exudyn", "sympy", "mujoco")


def about_machine() -> tuple[str, ...]:
    """Processor and system in one sentence, versions in another."""
    processor = _model() or platform.processor() or platform.machine()
    packages = [f"{name} {number}" for name in _PACKAGES if (number := _version(name))]
    return (
        f"{processor}, {os.cpu_count()} cores, {platform.system()} {platform.release()}",
        ", ".join([f"Python {platform.python_version()}", *packages]),
    )


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""


def _model() -> str:
    """What Linux calls the processor; elsewhere nothing."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return ""
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else ""
