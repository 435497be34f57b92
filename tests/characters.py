"""Characters of random texts: all of Latin, controls and what often breaks programs.

Hypothesis would draw from all of Unicode, of which it makes a table first, in each process of a fresh clone: 200 MB.
"""

from hypothesis import strategies as st

CHARACTERS = "".join(map(chr, [*range(0x250), *b"\n\r\t\0", 0x3B1, 0x5D0, 0x2028, 0x202E, 0xFEFF, 0xFFFF, 0x1F600]))


def texts(**sizes: int) -> st.SearchStrategy[str]:
    """As `hypothesis.strategies.text`."""
    return st.text(CHARACTERS, **sizes)
