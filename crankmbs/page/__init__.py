"""The page that computes in the browser: its document, its modules in JavaScript, and a scene as
they take it.

What only Python can run is named in refusals, with the command that does.
"""

from crankmbs.page.document import page_of
from crankmbs.page.export import exported
from crankmbs.page.refusals import refusals
from crankmbs.page.script import joined

__all__ = ["exported", "joined", "page_of", "refusals"]
