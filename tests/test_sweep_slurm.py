"""The manual's script for SLURM, run as it stands but for its size, under a stand-in for SLURM."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from crankmbs import load_sweep

pytestmark = pytest.mark.slow

pytest.importorskip("dask_jobqueue", reason="of the extra cluster")

PAGE = Path(__file__).parent.parent / "docs" / "howto" / "sweep.md"
SBATCH = """#!/bin/sh
cp "$1" job.sh
sh job.sh > job.log 2>&1 &
echo "Submitted batch job $!"
"""
SCANCEL = """#!/bin/sh
kill "$@" 2> /dev/null
"""


def test_the_script_of_the_manual_runs(tmp_path):
    block = PAGE.read_text(encoding="utf-8").split("```py\n# on_slurm.py\n")[1].split("```")[0]
    for size, small in (("cores=8, processes=8", "cores=1, processes=1"), ("jobs=4", "jobs=1")):
        assert block.count(size) == 1
        block = block.replace(size, small)
    (tmp_path / "on_slurm.py").write_text(block)
    for name, text in (("sbatch", SBATCH), ("scancel", SCANCEL)):
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)
    words = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"}
    done = subprocess.run(
        [sys.executable, "on_slurm.py"],
        cwd=tmp_path,
        env=words,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    script = (tmp_path / "job.sh").read_text()
    for line in ("#SBATCH -n 1", "#SBATCH --cpus-per-task=1", "#SBATCH -t 04:00:00"):
        assert line in script
        assert line in done.stdout
    assert "dask_worker tcp://" in script
    found = load_sweep(tmp_path / "map.zarr")
    assert found["status"].values.tolist() == [0] * 8
