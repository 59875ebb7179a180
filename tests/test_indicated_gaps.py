"""Cycles without some of their rows are left out, and the others stay as they are."""

import numpy as np
import pytest
from exports import FIRED, text

from crankmbs import InputError, read_pressure
from validation.oracles.measured import pressure_of

COUNT = 5
ANGLE = np.arange(0.0, 720.0 * COUNT)
GAIN = 1.0 + 0.02 * np.array([3.0, -1.0, 2.0, 0.0, -2.0, 1.0])  # of each firing
AT_360 = pressure_of(FIRED, ANGLE - 360.0) * GAIN[(ANGLE // 720.0).astype(int)]
AT_0 = pressure_of(FIRED, ANGLE) * GAIN[((ANGLE + 360.0) // 720.0).astype(int)]
TOP = 1e5 * pressure_of(FIRED, np.arange(-360.0, 360.0)).max()


def read(tmp_path, angle, columns, gone, **options):
    """The cylinders of a file without the rows at some places."""
    names = ["CA", *(f"PCYL{k + 1}" for k in range(len(columns)))]
    kept = np.delete(np.arange(len(angle)), gone)
    path = tmp_path / "gaps.csv"
    units = ["deg", *["bar(a)"] * len(columns)]
    path.write_text(text([angle[kept], *(each[kept] for each in columns)], names, units))
    return read_pressure(path, **options)


@pytest.mark.parametrize("angle", [ANGLE, ANGLE % 720.0], ids=["in one piece", "again from 0"])
@pytest.mark.parametrize(
    ("gone", "without", "sentence"),
    [
        (range(1700, 1750), [2], "1 of 5 cycles: 50 of the 720 of cycle 3, from 260 degrees (lin"),
        ([1700], [2], "1 of 5 cycles: 1 of the 720 of cycle 3, from 260 degrees (line 1703)"),
        ([400, 401, 3000], [0, 4], "2 of 5 cycles: 2 of the 720 of cycle 1, from 400 degrees (lin"),
        (range(1430, 1450), [1, 2], "2 of 5 cycles: 10 of the 720 of cycle 2, from 710 degrees (l"),
    ],
    ids=["fifty rows", "a row", "two cycles", "across the end"],
)
def test_a_cycle_without_some_rows_is_left_out(tmp_path, angle, gone, without, sentence):
    found = read(tmp_path, angle, [AT_360], gone)
    (cylinder,) = found.cylinders
    left = np.delete(GAIN[:COUNT], without)
    assert cylinder.peaks == pytest.approx(left * TOP, rel=1e-5)
    assert np.max(found.table.y) == pytest.approx(np.mean(left) * TOP, rel=1e-5)
    said = str(found)
    assert f"rows are missing in {sentence}" in said
    listed = ", ".join(str(k + 1) for k in without)
    assert f"PCYL1: {len(without)} of 5 cycles are left out for missing rows, or " in said
    assert f"missing cells in a row: {listed}; the others are numbered without them" in said
    scatter = np.std(left * TOP, ddof=1) / 1e5
    assert f"over {len(left)} cycles the peak scatters by {scatter:.3g} bar" in said


def test_a_cycle_of_which_all_rows_are_missing_is_one_of_them(tmp_path):
    found = read(tmp_path, ANGLE, [AT_360], range(720, 1440))
    assert found.cylinders[0].peaks == pytest.approx(GAIN[[0, 2, 3, 4]] * TOP, rel=1e-5)
    assert "720 of the 720 of cycle 2, from 0 degrees (line 723)" in str(found)


def test_what_a_file_begins_and_ends_with_is_no_gap(tmp_path):
    gone = [*range(100), 2000, *range(3500, 3600)]
    found = read(tmp_path, ANGLE % 720.0, [AT_360], gone)
    assert found.cylinders[0].peaks == pytest.approx(GAIN[[1, 3]] * TOP, rel=1e-5)
    for words in ("begins within a cycle: 620 rows", "ends within a cycle: 620 rows"):
        assert f"the file {words} of it are left out" in found.sentences
    assert "rows are missing in 1 of 3 cycles: 1 of the 720 of cycle 2, " in str(found)


def test_the_end_of_a_cycle_is_joined_only_to_the_beginning_of_the_next(tmp_path):
    found = read(tmp_path, ANGLE, [AT_0], [1700])  # firings 2 and 3 lie half in the third cycle
    assert found.cylinders[0].peaks == pytest.approx(GAIN[[1, 4]] * TOP, rel=1e-5)
    assert "5 recorded cycles give 2 whole ones" in str(found)


def test_cycles_that_stand_alone_are_closed_in_themselves(tmp_path):
    found = read(tmp_path, ANGLE, [AT_0], [800, 2300])
    assert len(found.cylinders[0].peaks) == 3
    assert found.table.x[-1] < 4.0 * np.pi


def test_cycles_of_several_cylinders_stand_beside_one_another_only_without_gaps(tmp_path):
    columns = [AT_360, AT_0]
    with pytest.raises(InputError, match="the cycles of cylinder 1 do not follow one another, so"):
        read(tmp_path, ANGLE, columns, [1700], cycles="all")
    one = read(tmp_path, ANGLE, columns[:1], [1700], cycles="all")
    assert "the table holds cycles 1 to 4 of 4, which do not all follow; " in str(one)
    whole = read(tmp_path, ANGLE, columns, [], cycles="all")
    assert "the table holds cycles 1 to 3 of 3; " in str(whole)


def test_one_whole_cycle_is_enough(tmp_path):
    gone = [100, *range(900, 902), *range(1600, 1603), *range(2300, 2304)]
    found = read(tmp_path, ANGLE, [AT_360], gone)
    assert found.cylinders[0].peaks == pytest.approx(GAIN[[4]] * TOP, rel=1e-5)
    assert "PCYL1: 4 of 5 cycles are left out" in str(found)


def test_a_row_too_many_is_refused(tmp_path):
    extra = np.insert(ANGLE, 1000, 999.5)
    with pytest.raises(InputError, match=r"line 1003: cycle 2 is not at the angles of the others"):
        read(tmp_path, extra, [np.insert(AT_360, 1000, 1.0)], [])
