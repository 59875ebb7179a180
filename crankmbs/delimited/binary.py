"""Files that are no text: what they are, by their first bytes or their ending, and the way out."""

from __future__ import annotations

from pathlib import PurePath

from crankmbs.errors import InputError

__all__ = ["refuse_controls", "refuse_known"]

_EXPORT = "export it from the indicating system as text (CSV, ASCII) over the crank angle"
_CHANNELS = (
    "save its channels as CSV, pressures over the crank angle, or over time beside the signal of a "
    "wheel or an encoder"
)
_SAVE = "save its sheet as CSV"
_UNPACK = "unpack it first"
_KINDS = (  # first bytes, what it is, the way out
    (b"MDF     ", "an MDF measurement file (MF4, MDF, DAT)", _CHANNELS),
    (b"UnFinMF ", "an MDF measurement file (MF4) that was not finished", _CHANNELS),
    (b"TDSm", "a TDMS file of LabVIEW", _CHANNELS),
    (b"TDSh", "the index of a TDMS file of LabVIEW", _CHANNELS),
    (b"\x89HDF\r\n\x1a\n", "an HDF5 file (also MATLAB's from 7.3 on, and NetCDF-4)", _CHANNELS),
    (b"MATLAB 5.0", "a MATLAB file", 'save angle and pressures with writematrix(data, "a.csv")'),
    (b"CDF\x01", "a NetCDF file", "save angle and pressures as CSV"),
    (b"CDF\x02", "a NetCDF file", "save angle and pressures as CSV"),
    (b"PAR1", "a Parquet file", "save angle and pressures as CSV"),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "an Excel file (xls) or another of Office", _SAVE),
    (b"PK\x03\x04", "an Excel file (xlsx), or a zip archive", f"{_SAVE}, or {_UNPACK}"),
    (b"\x1f\x8b", "a gzip archive", _UNPACK),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", _UNPACK),
    (b"%PDF", "a PDF document", _EXPORT),
    (b"\x89PNG", "a picture", _EXPORT),
)
_ENDINGS = {
    ".tdms": "a TDMS file of LabVIEW",
    ".mf4": "an MDF measurement file",
    ".mdf": "an MDF measurement file",
    ".ifl": "an iFile of an indicating system",
    ".ifile": "an iFile of an indicating system",
    ".i": "an iFile of an indicating system",
    ".h5": "an HDF5 file",
    ".hdf5": "an HDF5 file",
    ".mat": "a MATLAB file",
    ".dxd": "a data file of a recorder",
    ".d7d": "a data file of a recorder",
    ".open": "a data file of an indicating system",
}
_PROBE = 65_536  # characters: more than any header before the first row of numbers
_CONTROLS = dict.fromkeys(set(range(1, 32)) - set(b"\t\n\r\x0c\x1a\x1b"))


def refuse_known(content: bytes, name: str) -> None:
    """Refuse a file whose first bytes say that it is no text.

    Raises
    ------
    InputError : what it is, and the way out

    >>> refuse_known(b"angle,pressure", "a.csv")
    """
    for begin, kind, way_out in _KINDS:
        if content.startswith(begin):
            raise InputError(f"file {name} is {kind}, and only text is read; {way_out}")


def refuse_controls(text: str, name: str) -> None:
    """Refuse a decoded file with characters that no text has, in earnest.

    Raises
    ------
    InputError : what it is by its ending, and the way out
    """
    probe = text[:_PROBE]
    controls = len(probe) - len(probe.translate(_CONTROLS))
    if "\0" not in probe and controls <= 0.001 * len(probe) + 1:
        return
    ending = PurePath(name).suffix.lower()
    numbered = ending[1:].isdigit() and len(ending) == 4
    kind = "an iFile of an indicating system" if numbered else _ENDINGS.get(ending, "")
    kind = f"binary, by its name {kind}" if kind else "binary"
    raise InputError(f"file {name} is {kind}, and only text is read; {_EXPORT}")
