"""What an index would get: an archive of the source, a wheel made from it, and their metadata."""

import email
import re
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest
from links import TRACKED, targets

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parent.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
NAMED = f"crankmbs-{PROJECT['version']}"


def build(kind, source, folder):
    command = [sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", str(folder)]
    subprocess.run(command, cwd=source, check=True, capture_output=True)


@pytest.fixture(scope="module")
def sdist(tmp_path_factory):
    """The folder that an archive of the source unpacks to."""
    folder = tmp_path_factory.mktemp("sdist")
    build("sdist", ROOT, folder)
    with tarfile.open(folder / f"{NAMED}.tar.gz") as archive:
        archive.extractall(folder, filter="data")
    return folder / NAMED


@pytest.fixture(scope="module")
def wheel(sdist):
    """A folder of what the wheel, made from the archive, would install."""
    build("wheel", sdist, sdist.parent)
    (file,) = sdist.parent.glob("*.whl")
    with zipfile.ZipFile(file) as archive:
        archive.extractall(sdist.parent / "wheel")
    return sdist.parent / "wheel"


def test_every_tracked_file_of_the_package_is_in_both(sdist, wheel):
    ours = [name for name in TRACKED if name.startswith(("crankmbs/", "models/"))]
    assert "crankmbs/py.typed" in ours
    assert [name for name in ours if not (sdist / name).is_file()] == []
    installed = [re.sub(r"^models/", "crankmbs/_models/", name) for name in ours]
    assert [name for name in installed if not (wheel / name).is_file()] == []
    assert {file.name for file in wheel.iterdir()} == {"crankmbs", f"{NAMED}.dist-info"}


def test_the_metadata_are_whole_and_alike(sdist, wheel):
    text = (wheel / f"{NAMED}.dist-info" / "METADATA").read_text(encoding="utf-8")
    assert (sdist / "PKG-INFO").read_text(encoding="utf-8") == text
    said = email.message_from_string(text)
    assert (wheel / f"{NAMED}.dist-info" / "licenses" / "LICENSE").is_file()
    for key in ("Summary", "Author", "License-Expression", "Keywords"):
        assert said[key]
    tried = re.findall(r"Python (3[\d., and]+), on Linux", CONTRIBUTING)[0]
    minors = re.findall(r"Python :: (3\.\d+)", " ".join(said.get_all("Classifier")))
    assert minors == re.findall(r"3\.\d+", tried)
    assert said["Requires-Python"] == f">={minors[0]}"


def test_the_description_leads_nowhere_that_an_index_lacks(wheel):
    text = (wheel / f"{NAMED}.dist-info" / "METADATA").read_text(encoding="utf-8")
    description = email.message_from_string(text).get_payload()
    assert targets(description) == []
    assert "python -m pip install crankmbs && crankmbs run yi_diesel_free" in description
    assert not re.search(r"pip install (-e )?\.|this file|docs/|!\[", description)
    assert description.startswith("# crankmbs\n")
    assert description.endswith("## License\n\nMIT\n")


def test_what_builds_it_is_there_for_this_test():
    assert set(PYPROJECT["build-system"]["requires"]) <= {*PROJECT["optional-dependencies"]["test"]}


def test_every_dependency_has_its_row_and_no_other():
    (table,) = re.findall(r"^\| library \|.*?\n\n", CONTRIBUTING, re.MULTILINE | re.DOTALL)
    rows = [line.split("|")[1] for line in table.splitlines()[2:] if line]
    named = [name.strip() for row in rows for name in row.split(",")]
    needed = [re.match(r"[\w-]+", line)[0] for line in PROJECT["dependencies"]]
    assert sorted(named) == sorted(needed)
