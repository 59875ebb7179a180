"""The page that computes in the browser: its document, its modules in JavaScript, and a scene as
they take it.

What only Python can run is named in refusals; the page replays it (`film`).
"""

from crankmbs.page.document import filled, given_of, page_of
from crankmbs.page.export import encoded, exported
from crankmbs.page.refusals import refusals
from crankmbs.page.script import FOLDER, joined

__all__ = [
    "FOLDER",
    "encoded",
    "exported",
    "filled",
    "given_of",
    "joined",
    "page_of",
    "refusals",
]
