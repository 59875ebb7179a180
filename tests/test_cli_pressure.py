"""The command pressure: a table, figures and sentences."""

import numpy as np
import pytest
from command_line import crankmbs_, names, refused
from exports import FIRED, HEADER, columns_of_cycles, cycles, text
from scene_texts import FREE, INDICATOR, edited

from crankmbs import load_scene, read_pressure
from crankmbs.figures.indicated import volume_figure

ANGLE = np.arange(-360.0, 360.0, 1.0)


@pytest.fixture
def export(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    values = cycles(FIRED, ANGLE, 5, noise=0.05)
    (tmp_path / "export.csv").write_text(columns_of_cycles(ANGLE, values), encoding="utf-16")
    return tmp_path


@pytest.mark.slow
def test_it_writes_table_and_figures_and_says_what_was_done(export):
    result = crankmbs_("pressure", "export.csv", "-o", "out/table.csv")
    assert result.exit_code == 0, result.output
    figures = {"table_angle.png", "table_pv.png", "table_cycles.png"}
    assert names(export / "out") == {"table.csv", *figures}
    for sentence in (
        "export.csv: 720 rows of 6 columns from line 7 on, UTF-16, separated by semicolons, "
        "decimal comma; 4-stroke, -360 to 359 degrees in steps of 1",
        "the header gives bore 85.25 mm, stroke 92 mm, rod length 153.333 mm, compression ratio 18",
        "wrote out: table.csv, table_angle.png, table_pv.png, table_cycles.png",
        '  pressure = "out/table.csv"',
    ):
        assert sentence in result.stdout
    assert str(export) not in (export / "out" / "table.csv").read_text()


def test_each_panel_over_the_volume_says_what_its_axes_are(export):
    panels = volume_figure(read_pressure("export.csv")).axes
    assert [ax.get_ylabel() for ax in panels] == ["cylinder pressure, absolute [bar]"] * 2
    assert "clearance" in panels[1].get_xlabel()


def test_by_default_it_writes_into_results(export):
    result = crankmbs_("pressure", "export.csv", "--no-figures")
    assert result.exit_code == 0, result.output
    assert names(export / "results" / "export") == {"pressure.csv"}
    assert '  pressure = "results/export/pressure.csv"\n' in result.stdout


def test_the_path_is_from_where_the_scene_stands(export):
    """As a scene reads it: pasted into the scene, the table is found."""
    (export / "machines").mkdir()
    scene = edited(FREE, 'pressure = "gas.csv"\nabsolute = false\n', INDICATOR)
    (export / "machines" / "mine.toml").write_text(scene)
    arguments = "export.csv", "--scene", "machines/mine.toml", "-o", "out/table.csv"
    result = crankmbs_("pressure", *arguments, "--reference", "absolute", "--no-figures")
    assert result.exit_code == 0, result.output
    lines = result.stdout.split("as [gas] of a scene:\n")[1]
    assert lines.startswith('  pressure = "../out/table.csv"\n')
    pasted = edited(FREE, 'pressure = "gas.csv"\nabsolute = false\n', lines)
    (export / "machines" / "mine.toml").write_text(pasted)
    assert crankmbs_("check", "machines/mine.toml").exit_code == 0


def test_a_question_is_put_in_words_of_the_command_line(export):
    (export / "b.csv").write_text(text([ANGLE, ANGLE], ["CA", "PCYL1"]))
    assert refused("pressure", "b.csv").endswith(
        'give --unit "bar" or another of kPa, Pa, MPa, psi, with --reference "absolute" or "gauge" '
        "unless the compression shows it"
    )
    said = refused("pressure", "b.csv", "--loss-angle", "1 m")
    assert said == '--loss-angle: "1 m" is no angle here: use rad, deg or rev'
    said = refused("pressure", "export.csv", "-o", "export.csv")
    assert said == "-o: export.csv is the file that is read; choose another name"


def test_a_file_that_is_no_table_is_not_overwritten(export):
    scene = export / "mine.toml"
    scene.write_text(FREE)
    said = refused("pressure", "export.csv", "-o", "mine.toml")
    assert said.startswith("mine.toml: exists already, is no table of this command")
    assert scene.read_text() == FREE
    for _ in range(2):  # a table is made anew
        assert crankmbs_("pressure", "export.csv", "-o", "t.csv", "--no-figures").exit_code == 0


def test_the_table_in_a_scene_gives_its_imep(export):
    """The mean effective pressure of a run is that of the file, by another quadrature."""
    from crankmbs import simulate
    from crankmbs.measures import measure

    scene = """
[crank]
radius = "46 mm"
[rod]
length = "153.3333 mm"
[piston]
mass = "1.1 kg"
bore = "85.25 mm"
[gas]
pressure = "table.csv"
ambient = "1 bar"
[motion]
speed = "2000 rpm"
[run]
until = "1 cycles"
"""
    found = read_pressure("export.csv")
    found.save("table.csv")
    (export / "scene.toml").write_text(scene)
    result = simulate(load_scene(export / "scene.toml"))
    (imep,) = measure(result).imep
    assert imep.value == pytest.approx(float(np.mean(found.cylinders[0].imep)), rel=1e-4)


def test_a_header_without_lengths_draws_no_volume(export):
    content = columns_of_cycles(ANGLE, cycles(FIRED, ANGLE, 1), head=HEADER[:15], reference="(a)")
    (export / "c.csv").write_text(content)
    result = crankmbs_("pressure", "c.csv", "-o", "c_table.csv")
    assert result.exit_code == 0, result.output
    assert {"c_table.csv", "c_table_angle.png"} <= names(export)
    assert "c_table_pv.png" not in names(export)
    assert "without a scene no imep and no volumes are found" in result.stdout
