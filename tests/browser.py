"""Debian's chromium for the tests that need a browser."""

import fcntl
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import pytest

_INSTALL = (
    ["apt-get", "update"],
    ["apt-get", "install", "--yes", "--no-install-recommends", "chromium"],
)


def chromium():
    """The path of chromium, installed by apt-get where that can be; else the test is skipped."""
    if shutil.which("chromium") is None and os.geteuid() == 0 and shutil.which("apt-get"):
        with Path(tempfile.gettempdir(), "crankmbs-chromium.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)  # several processes test at once
            if shutil.which("chromium") is None:
                for command in _INSTALL:
                    subprocess.run(command, check=False, capture_output=True)
    path = shutil.which("chromium")
    if path is None:
        missing = "chromium is missing and cannot be installed here: apt-get install chromium"
        if os.environ.get("CI", "").lower() == "true":
            pytest.fail(missing)
        pytest.skip(missing)
    return path
