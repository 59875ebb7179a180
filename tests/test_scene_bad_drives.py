"""Bad [start], [motion], [[torque]] or [run] in a scene gets one sentence."""

import pytest
from scene_texts import DRIVEN, FREE, edited, refusal

EXTENT = 'must be an angle or a time with its unit, such as "20 cycles", "10 rev" or "0.75 s"'
KINDS = "constant, viscous, quadratic, time_table, speed_table, angle_table"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        # start, torque, run
        (
            '[start]\nangle = "0 deg"\nspeed = "3200 rpm"',
            "",
            "give [motion] (the speed is prescribed) or [start] (the crank is free), exactly one "
            "of the two; neither came",
        ),
        (
            "[start]",
            '[motion]\nspeed = "1 rpm"\n[start]',
            "give [motion] (the speed is prescribed) or [start] (the crank is free), exactly one "
            "of the two; both came",
        ),
        (
            'speed = "3200 rpm"',
            '[motion]\nspeed = "1 rpm"',
            "give [motion] (the speed is prescribed) or [start] (the crank is free), exactly one "
            "of the two; both came",
        ),
        (
            '[run]\nuntil = "0.75 s"',
            "",
            'run: this key is missing; add [run] with until, such as until = "20 cycles"; it may '
            "have every, rtol, formulation",
        ),
        ('"quadratic"', '"cubic"', f'torque[1]: kind must be one of {KINDS}; "cubic" came'),
        (
            '"quadratic"',
            '"quadratik"',
            f'torque[1]: kind must be one of {KINDS}; "quadratik" came; did you mean "quadratic"?',
        ),
        ('"quadratic"', "[]", f"torque[1]: kind must be one of {KINDS}; [] came"),
        ('kind = "quadratic"', "", f"torque[1]: kind must be one of {KINDS}; none came"),
        ('"9.5e-5 N m s^2"', "-1", "torque[1].coefficient: must be at least 0; -1 came"),
        (
            '"9.5e-5 N m s^2"',
            '"1 N m s"',
            'torque[1].coefficient: "1 N m s" is no quadratic coefficient here: use N m s^2 or '
            "N m/rpm^2",
        ),
        ('"0.75 s"', "0.75", f"run.until: {EXTENT}; 0.75 came"),
        ('"0.75 s"', "true", f"run.until: {EXTENT}; true came"),
        (
            '"0.75 s"',
            '{ value = 1.0, unit = "s" }',
            f"run.until: {EXTENT}; a table with value, unit came",
        ),
        (
            '"0.75 s"',
            '"none"',
            'run.until: "none" is not a quantity: write one number and one unit, such as '
            '"20 cycles", "10 rev" or "0.75 s"',
        ),
        ('"0.75 s"', '"0 s"', 'run.until: must be finite and above 0; "0 s" came'),
        ('"0.75 s"', '"-3 rev"', 'run.until: must be finite and above 0; "-3 rev" came'),
        (
            '"0.75 s"',
            '"3 m"',
            'run.until: "3 m" is no angle or time: use cycles, rev, deg, rad or s',
        ),
        (
            'until = "0.75 s"',
            "",
            'run.until: this key is missing; give it, such as until = "20 cycles"',
        ),
        ('"0.75 s"', '"1 s"\nevery = 1', f"run.every: {EXTENT}; 1 came"),
        (
            '"0.75 s"',
            '"1 s"\nevery = "0 deg"',
            'run.every: must be finite and above 0; "0 deg" came',
        ),
        ('"0.75 s"', '"1 s"\nrtol = 1e-15', "run.rtol: must be at least 1e-13; 1e-15 came"),
        ('"0.75 s"', '"1 s"\nrtol = nan', "run.rtol: must be finite; nan came"),
        ('"0.75 s"', '"1 s"\nrtol = 1', "run.rtol: must be at most 0.01; 1 came"),
        ('"0.75 s"', '"1 s"\nrtol = "1e-8"', 'run.rtol: must be a number; "1e-8" came'),
    ],
)
def test_a_bad_drive_gets_one_sentence(read, old, new, message):
    assert refusal(read, edited(FREE, old, new)) == message


@pytest.mark.parametrize(
    ("speed", "message"),
    [
        ("0", 'speed: needs a unit, such as "3200 rpm"; 0 came'),
        ('"0 rpm"', "speed: at speed 0 no angle is ever reached; until must be a time"),
        (
            '{ mean = "1 rpm", amplitud = 1 }',
            'speed.amplitud: unknown key; did you mean "amplitude"?',
        ),
        ('{ meen = "1 rpm", amplitude = 1 }', 'speed.meen: unknown key; did you mean "mean"?'),
        (
            '{ mean = "1 rpm" }',
            'speed.amplitude: this key is missing; give it, such as amplitude = "40 rpm"',
        ),
        (
            '{ mean = "3 rpm", amplitude = "-1 rpm", order = 1 }',
            'speed.amplitude: must be at least 0; "-1 rpm" came',
        ),
        (
            '{ mean = "30 rpm", amplitude = "60 rpm", order = 1 }',
            "speed: amplitude must be below the mean speed, or the crank stops; 6.28319 and "
            "3.14159 rad/s came",
        ),
        (
            '{ mean = "3 rpm", amplitude = "1 rpm", order = 0 }',
            "speed.order: must be above 0; 0 came",
        ),
        (
            '{ from = 1, to = "1 rpm", over = 1 }',
            'speed.from: needs a unit, such as "3200 rpm"; 1 came',
        ),
        ('{ from = "1 rpm", to = "1 rpm", over = -1 }', "speed.over: must be above 0; -1 came"),
        (
            '{ from = "1 rpm", too = "1 rpm", over = 1 }',
            'speed.too: unknown key; did you mean "to"?',
        ),
        (
            '{ start = "1 rpm", to = "1 rpm", over = 1 }',
            "speed.start: unknown key; known keys are from, to, over",
        ),
        (
            '{ frm = "1 rpm", to = "1 rpm", over = 1 }',
            'speed.frm: unknown key; did you mean "from"?',
        ),
        (
            '{ to = "1 rpm", over = 1 }',
            'speed.from: this key is missing; give it, such as from = "800 rpm"',
        ),
        (
            "{}",
            'speed: must be a speed such as "3200 rpm", or a table with mean, amplitude, order, '
            "or with from, to, over, or with file; an empty table came",
        ),
        (
            '{ file = "speed.csv" }',
            "speed.file: file speed.csv is missing; paths are relative to the scene file",
        ),
        ("{ file = 3 }", "speed.file: must be the name of a CSV file; 3 came"),
        (
            '{ file = "speed.csv", kind = "angle_table" }',
            "speed: kind is no key of a speed: the columns of its file say what it is over",
        ),
        (
            '{ file = "gas.csv", interpolation = "linear" }',
            "speed.file: file gas.csv: the header must name exactly one column speed_rpm, with "
            'commas between the columns; "crank_angle_deg,pressure_bar" came',
        ),
    ],
)
def test_a_bad_speed_gets_one_sentence(read, speed, message):
    assert refusal(read, edited(DRIVEN, '"3200 rpm"', speed)) == f"motion.{message}"


def test_a_prescribed_speed_takes_no_torque(read):
    loaded = edited(DRIVEN, "[run]", '[[torque]]\nkind = "constant"\ntorque = 1\n[run]')
    assert refusal(read, loaded) == (
        "torque: with [motion] the drive is an answer, not a load; remove [[torque]], or free the "
        "crank with [start]"
    )


TABLES = {
    "time_table": ("time_s,torque_Nm", "times"),
    "speed_table": ("speed_rpm,torque_Nm", "speeds"),
}


@pytest.mark.parametrize("kind", TABLES)
@pytest.mark.parametrize(
    ("rows", "rule"),
    [
        ("0,1\n", "the table needs at least two rows; 1 came"),
        ("0,1\n2,3\n1,4\n", "{} must not decrease (two equal ones are a jump); row 3 breaks this"),
        (
            "0,1\n0,3\n0,4\n2,4\n",
            "{} must not decrease (two equal ones are a jump); row 3 breaks this",
        ),
    ],
)
def test_a_bad_torque_table(read, tmp_path, kind, rows, rule):
    header, what = TABLES[kind]
    (tmp_path / "load.csv").write_text(f"{header}\n{rows}")
    loaded = edited(
        edited(FREE, '"quadratic"', f'"{kind}"'),
        'coefficient = "9.5e-5 N m s^2"',
        'file = "load.csv"',
    )
    assert refusal(read, loaded) == f"torque[1]: load.csv: {rule.format(what)}"


@pytest.mark.parametrize("kind", TABLES)
def test_a_torque_table_may_jump(read, tmp_path, kind):
    (tmp_path / "load.csv").write_text(f"{TABLES[kind][0]}\n0,1\n0.5,1\n0.5,2\n1,3\n")
    loaded = edited(
        edited(FREE, '"quadratic"', f'"{kind}"'),
        'coefficient = "9.5e-5 N m s^2"',
        'file = "load.csv"',
    )
    assert read(loaded).torque[0].file.y == (1.0, 1.0, 2.0, 3.0)


@pytest.mark.parametrize(
    ("rows", "span"), [("0,1\n0.5,2\n", "0 to 0.5"), ("0.1,1\n2,2\n", "0.1 to 2")]
)
def test_a_time_table_covers_the_run(read, tmp_path, rows, span):
    rule = f"the table must cover the run, 0 to 0.75 s; it goes from {span} s"
    (tmp_path / "load.csv").write_text(f"time_s,torque_Nm\n{rows}")
    loaded = edited(
        edited(FREE, '"quadratic"', '"time_table"'),
        'coefficient = "9.5e-5 N m s^2"',
        'file = "load.csv"',
    )
    assert refusal(read, loaded) == f"load.csv: {rule}"
    (tmp_path / "speed.csv").write_text(f"time_s,speed_rpm\n{rows}")
    driven = edited(edited(DRIVEN, '"3200 rpm"', '{ file = "speed.csv" }'), '"1 cycle"', '"0.75 s"')
    if rows.startswith("0,"):  # a later begin is that of the run
        assert refusal(read, driven) == f"speed.csv: {rule}"
    else:
        assert read(driven).motion.speed.file.x == pytest.approx((0.0, 1.9))


def test_a_speed_table_does_not_jump(read, tmp_path):
    (tmp_path / "speed.csv").write_text("time_s,speed_rpm\n0,1\n1,2\n1,3\n")
    driven = edited(DRIVEN, '"3200 rpm"', '{ file = "speed.csv" }')
    assert refusal(read, driven) == (
        "motion.speed: speed.csv: times must strictly increase; row 3 breaks this"
    )
