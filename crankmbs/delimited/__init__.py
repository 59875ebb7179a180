"""Text that others write into files: bytes to text, text to rows of numbers under headings.

It knows encodings, separators, decimal signs and where a table begins, and nothing of engines.
"""

from crankmbs.delimited.encoding import Text, decode
from crankmbs.delimited.sheet import Dialect, Sheet, read_sheet

__all__ = ["Dialect", "Sheet", "Text", "decode", "read_sheet"]
