"""Bytes to text: byte order marks, UTF-16, UTF-8, and the code page of Western Windows."""

from __future__ import annotations

import codecs
from typing import NamedTuple

from crankmbs.delimited.binary import refuse_controls, refuse_known
from crankmbs.errors import InputError

__all__ = ["Text", "decode"]

_MARKS = (  # the longer ones first: that of UTF-16 begins that of UTF-32
    (codecs.BOM_UTF32_LE, "UTF-32"),
    (codecs.BOM_UTF32_BE, "UTF-32"),
    (codecs.BOM_UTF8, "UTF-8-sig"),
    (codecs.BOM_UTF16_LE, "UTF-16"),
    (codecs.BOM_UTF16_BE, "UTF-16"),
)
_PROBE = 4096  # bytes from which UTF-16 without a mark is told
_EVERY_OTHER = 0.4  # of the bytes are 0 at least in UTF-16 of Western text
_NAMES = {"UTF-8-sig": "UTF-8", "cp1252": "Windows-1252"}


class Text(NamedTuple):
    """A file's text, its lines ended by a line feed, and the encoding that it had."""

    text: str
    encoding: str


def decode(content: bytes, name: str) -> Text:
    """The text of a file, by its byte order mark, else as UTF-16, UTF-8 or Windows-1252.

    Raises
    ------
    InputError : a binary file, named where it is known, with the way out

    >>> decode("Druck;1,5".encode("utf-16"), "a.csv")
    Text(text='Druck;1,5', encoding='UTF-16')
    """
    refuse_known(content, name)
    encoding = next((each for mark, each in _MARKS if content.startswith(mark)), "")
    encoding = encoding or _without_mark(content[:_PROBE])
    text, encoding = _decoded(content, encoding, name)
    refuse_controls(text, name)
    return Text(text.replace("\r\n", "\n").replace("\r", "\n"), _NAMES.get(encoding, encoding))


def _decoded(content: bytes, encoding: str, name: str) -> tuple[str, str]:
    try:
        return content.decode(encoding), encoding
    except UnicodeDecodeError as error:
        if encoding != "UTF-8":
            raise InputError(
                f"file {name}: byte {error.start} is no {encoding}, as the file begins; export it "
                "again as text in UTF-8"
            ) from None
    return content.decode("cp1252", errors="replace"), "cp1252"


def _without_mark(probe: bytes) -> str:
    """UTF-16 has a 0 in every other byte of Western text."""
    half = max(len(probe) // 2, 1)
    for first, encoding in ((1, "UTF-16-LE"), (0, "UTF-16-BE")):
        zeros, others = probe[first::2].count(0), probe[1 - first :: 2].count(0)
        if zeros > _EVERY_OTHER * half and others == 0:
            return encoding
    return "UTF-8"
