"""What cannot be read is refused with one sentence: what, where, rule, what came, way out."""

import pytest
from command_line import crankmbs_, refused
from wrong_exports import WRONG

from crankmbs import InputError, UndecidedError, read_pressure

MESSAGES = {
    "MF4": (
        "file a.mf4 is an MDF measurement file (MF4, MDF, DAT), and only text is read; save its "
        "channels as CSV, pressures over the crank angle, or over time beside the signal of a "
        "wheel or an encoder"
    ),
    "TDMS": (
        "file a.tdms is a TDMS file of LabVIEW, and only text is read; save its channels as CSV, "
        "pressures over the crank angle, or over time beside the signal of a wheel or an encoder"
    ),
    "HDF5": (
        "file a.h5 is an HDF5 file (also MATLAB's from 7.3 on, and NetCDF-4), and only text is "
        "read; save its channels as CSV, pressures over the crank angle, or over time beside the "
        "signal of a wheel or an encoder"
    ),
    "iFile": (
        "file a.ifl is binary, by its name an iFile of an indicating system, and only text is "
        "read; export it from the indicating system as text (CSV, ASCII) over the crank angle"
    ),
    "numbered iFile": (
        "file motor.001 is binary, by its name an iFile of an indicating system, and only text "
        "is read; export it from the indicating system as text (CSV, ASCII) over the crank "
        "angle"
    ),
    "xlsx": (
        "file a.xlsx is an Excel file (xlsx), or a zip archive, and only text is read; save its"
        " sheet as CSV, or unpack it first"
    ),
    "xls": (
        "file a.xls is an Excel file (xls) or another of Office, and only text is read; save "
        "its sheet as CSV"
    ),
    "MATLAB": (
        "file a.mat is a MATLAB file, and only text is read; save angle and pressures with "
        'writematrix(data, "a.csv")'
    ),
    "gzip": ("file a.csv.gz is a gzip archive, and only text is read; unpack it first"),
    "binary": (
        "file a.csv is binary, and only text is read; export it from the indicating system as "
        "text (CSV, ASCII) over the crank angle"
    ),
    "empty": ("file a.csv is empty: it needs headings and rows of crank angle and pressure"),
    "no rows": (
        "file a.csv: no rows of at least two numbers were found in its first 2 lines; the last "
        'of them is "deg;bar"; give separator, decimal and skip, or export the table alone'
    ),
    "prose": (
        "file a.csv: no rows of at least two numbers were found in its first 2 lines; the last "
        'of them is "was not saved."; give separator, decimal and skip, or export the table '
        "alone"
    ),
    "over time": (
        "file a.csv: the record is over time, and no column is left for the signal of a wheel; "
        'the columns are "Time", "PCYL1"; record the wheel beside the pressure, or export the '
        "pressures over the crank angle"
    ),
    "no angle": (
        'file a.csv: no column is a crank angle by its name or its unit; the columns are "X", '
        '"PCYL1"; give angle="X"'
    ),
    "no pressure": (
        'file a.csv: no column is a pressure by its name or its unit; the columns are "CA", '
        '"TEMP"; name some, such as columns="PCYL1..4"'
    ),
    "no unit": (
        'file a.csv: the pressures of column "PCYL1" have no unit, neither in the name nor in a'
        ' row below the names; give unit="bar" or another of kPa, Pa, MPa, psi, with reference='
        '"absolute" or "gauge" unless the compression shows it'
    ),
    "another unit": (
        'file a.csv: unit="kPa" is for pressures without a unit, and column "PCYL1" is in bar; '
        "leave it out, or correct the heading"
    ),
    "no such column": (
        'file a.csv: columns: no column is named "PCYL7"; the columns are CA, PCYL1; did you mean '
        '"PCYL1"?'
    ),
    "no reference": (
        "file a.csv: the file does not say what its pressures are measured from; the gas "
        'exchange lies at -2.98 bar; give reference="absolute", reference="gauge", '
        'reference="inlet 1.0 bar" or reference="polytrope 1.32"'
    ),
    "a word in a cell": (
        'file a.csv, line 50: cell 2 must be a number with the decimal sign ",", or empty; '
        '"over" came; correct it, or give separator and decimal'
    ),
    "another row": (
        "file a.csv, line 50: every row must have 2 cells, as the first one has; 3 came, "
        '"-313,0;1,0;2,0"; export one table a file, or cut off what is no row'
    ),
    "a footer": (
        'file a.csv, line 723: every row must have 2 cells, as the first one has; 1 came, "end '
        'of file"; export one table a file, or cut off what is no row'
    ),
    "an angle missing": (
        "file a.csv, line 50: the crank angle is missing; complete the row, or cut it off"
    ),
    "an angle twice": (
        "file a.csv, line 50: the crank angle -314 comes twice, and it must rise; drop one of "
        "the rows"
    ),
    "an angle back": (
        "file a.csv, line 50: the crank angle goes from -314 back to -320 degrees, and it must "
        "rise to the end of the cycle; export the rows in order"
    ),
    "falling angles": (
        "file a.csv, line 3: the crank angle falls from row to row, and it must rise; turn the "
        "rows round, or the sign of the angle"
    ),
    "half a cycle": (
        "file a.csv: a cycle spans 359 degrees, which is the whole cycle of a two-stroke engine"
        " or half of a four-stroke one's; give stroke=4 with the whole cycle of 720 degrees or "
        "stroke=2"
    ),
    "two thirds": (
        "file a.csv: the rows span 479 degrees from -360 to 119, and a cycle has 360 or 720; "
        "export the whole cycle, gas exchange included"
    ),
    "stroke 4 of half a cycle": (
        "file a.csv: the rows span 359 degrees from -180 to 179, and a cycle has 720; export "
        "the whole cycle, gas exchange included; stroke=2 is for a two-stroke engine"
    ),
    "rows missing in every cycle": (
        "file a.csv, line 182: from 179 degrees the next row is 51 degrees on, where others are 1 "
        "degrees apart: rows are missing; export the cycle with all of them"
    ),
    "cycles at other angles": (
        "file a.csv, line 1443: cycle 3 is not at the angles of the others, 0.4 degrees "
        "came; resample the cycles to the same angles, or check stroke"
    ),
    "rows missing at the peak": (
        "file a.csv, line 352: from -11 degrees the next row is 44 degrees on, where others are 1 "
        "degrees apart: rows are missing; export the cycle with all of them"
    ),
    "missing everywhere": (
        "file a.csv: column PCYL1 has more than 3 missing cells in a row, at -261 degrees, in "
        "every cycle; choose other columns, or export it again"
    ),
    "upside down": (
        "file a.csv: PCYL1 is upside down: its largest excursion is downwards, to -67.82 bar; "
        'give invert=True, or give the names of the pressures alone, such as columns="PCYL1..4"'
    ),
    "a peak beside the dead centre": (
        "file a.csv: the peak of the pressure lies at 77 degrees, not near a multiple of 360: "
        'the angles do not count from a dead centre of this cylinder; give firing_tdc="... '
        "deg\", the file's angle of the firing dead centre"
    ),
    "two peaks": (
        "file a.csv: the pressure is as high at -360 degrees as 360 degrees later; give "
        "stroke=2 or stroke=4 with firing_tdc"
    ),
    "an odd lag": (
        "file a.csv: the cylinder of pressure column 2 fires 51 degrees after the first one, "
        "which no even firing has; give scene=..., whose layout says when it fires or "
        'columns="PCYL1" where the others are no pressures'
    ),
    "cycles or cylinders": (
        "file a.csv: the columns are named 1 to 2, and these may be cycles of one cylinder or "
        'cylinders; give each="cycle", each="cylinder" or columns="1" for a pressure alone'
    ),
    "two of one cylinder": (
        'file a.csv: "PCYL1" and "PCYL1_HP" may both be the pressure of cylinder 1; give '
        'columns="PCYL1" or columns="PCYL1_HP"'
    ),
    "intake alone": (
        "file a.csv: no column is the pressure of a cylinder; PINT came; name the column, such "
        'as columns="PCYL1"'
    ),
    "inlet without its column": (
        "file a.csv: the file has no column of the intake's pressure; give it, such as "
        'reference="inlet 1.0 bar"'
    ),
    "polytrope without geometry": (
        "file a.csv: a reference by polytrope needs stroke, rod length and compression ratio; "
        "give a scene and compression_ratio"
    ),
    "smooth without rows": (
        "file a.csv: smooth must span at least five rows, 4 degrees here, and less than the "
        "cycle; 2 degrees came"
    ),
    "a cycle that is not there": ("file a.csv: cycles must be among the 3 whole ones; 7 came"),
    "the wrong separator": (
        "file a.csv: no rows of at least two numbers, separated by tabs were found in its first"
        ' 722 lines; the last of them is "359,0000;1,1200"; give separator, decimal and skip, '
        "or export the table alone"
    ),
    "the wrong decimal sign": (
        'file a.csv: no rows of at least two numbers, with the decimal sign "." were found in '
        'its first 722 lines; the last of them is "359,0000;1,1200"; give separator, decimal '
        "and skip, or export the table alone"
    ),
}

ASKED = {
    "no angle",
    "no unit",
    "no reference",
    "half a cycle",
    "a peak beside the dead centre",
    "two peaks",
    "an odd lag",
    "cycles or cylinders",
    "two of one cylinder",
}


@pytest.fixture
def export(tmp_path, monkeypatch):
    """The file of a name in an empty folder, with its options."""
    monkeypatch.chdir(tmp_path)

    def write(name):
        file, content, options = WRONG[name]
        data = content if isinstance(content, bytes) else content.encode()
        (tmp_path / file).write_bytes(data)
        return file, options

    return write


def test_every_wrong_file_has_its_sentence():
    assert set(MESSAGES) == set(WRONG)


@pytest.mark.parametrize("name", WRONG)
def test_it_is_refused_with_one_sentence(export, name):
    file, options = export(name)
    with pytest.raises(InputError) as caught:
        read_pressure(file, **options)
    assert str(caught.value) == MESSAGES[name]
    assert isinstance(caught.value, UndecidedError) == (name in ASKED)
    if name in ASKED:
        assert all(option in MESSAGES[name] for option in caught.value.options)


@pytest.mark.parametrize("name", WRONG)
def test_the_command_ends_with_2_and_writes_nothing(export, tmp_path, name):
    file, options = export(name)
    words = [word for key, value in options.items() for word in (f"--{key}", str(value))]
    result = crankmbs_("pressure", file, *words)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    (message,) = result.stderr.strip().splitlines()
    assert message.startswith("error: ")
    assert [each.name for each in tmp_path.iterdir()] == [file]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"reference": "relative"}, 'reference: must be "absolute", "gauge" (with'),
        ({"reference": "polytrope 3"}, "reference: a polytrope's exponent lies between 1 and 2; "),
        (
            {"reference": "polytrope 1,32"},
            "reference: a polytrope's exponent lies between 1 and 2, with a decimal point; ",
        ),
        ({"reference": "absolute 1 bar"}, 'reference: "absolute" stands alone; '),
        ({"unit": "torr"}, "unit: must be one of bar, mbar, "),
        ({"stroke": 3}, "stroke: must be 2 or 4; 3 came"),
        ({"each": "row"}, 'each: must be "cycle" or "cylinder"; "row" came'),
        ({"cycles": "last"}, 'cycles: must be "mean", "all", the number of a cycle or a range'),
        ({"cycles": "5-2"}, 'cycles: a range of cycles goes up; "5-2" came'),
        ({"loss_angle": "0.7 mm"}, 'loss_angle: "0.7 mm" is no angle here: use rad, deg or rev'),
        ({"compression_ratio": 1.0}, "compression_ratio: must be above 1; 1.0 came"),
        ({"collumns": "P"}, 'collumns: unknown argument; did you mean "columns"?'),
        ({"skip": -1}, "skip: must be at least 0; -1 came"),
    ],
)
def test_a_bad_option_gets_one_sentence(options, message):
    with pytest.raises(InputError) as caught:
        read_pressure("no.csv", **options)
    assert str(caught.value).startswith(message)


def test_a_missing_file():
    with pytest.raises(InputError) as caught:
        read_pressure("no.csv")
    assert str(caught.value) == "file no.csv is missing; paths are relative to the working folder"


def test_a_signal_that_was_turned_over_needlessly(export):
    file, _ = export("no unit")
    said = refused("pressure", file, "--unit", "bar", "--invert")
    assert said == (
        "file a.csv: PCYL1 is upside down after --invert: its largest excursion is downwards, to "
        "-67.82 bar; leave it out, or give the names of the pressures alone, such as --columns "
        '"PCYL1..4"'
    )


@pytest.mark.parametrize(
    ("above", "row"),
    [
        ("time [s];pressure [bar];wheel", "0.1;1;0"),
        ("PCYL1;[bar]\n-;" + ";".join(str(k) for k in range(-360, 360)), "1" + 720 * ";1.5"),
    ],
)
def test_a_unit_for_pressures_that_have_one(tmp_path, above, row):
    """Over time, and one cycle a row."""
    (tmp_path / "a.csv").write_text("\n".join([above, *[row] * 9]))
    with pytest.raises(InputError, match=r'unit="kPa" is for pressures without a unit, and column'):
        read_pressure(tmp_path / "a.csv", unit="kPa", wheel="60-2")
