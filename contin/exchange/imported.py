"""What a reader of foreign files gives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from contin.errors import InputError
from contin.records import Record


class UnsupportedError(InputError):
    """A foreign model uses something that contin has no equal for; the text names the element and its place."""


@dataclass(frozen=True)
class Imported:
    """A foreign model as plain data.

    model : the mapping that a YAML model file holds (FORMATS, section 1).  notes : what the reader was not told or has
    left out, a sentence each.  run : the entries of a run file that the foreign file asks for (its ranges, times and
    settings), without `model`; None where it asks for nothing.
    """

    model: Record
    notes: tuple[str, ...] = ()
    run: Record | None = None


@dataclass(frozen=True)
class Exported:
    """A model as the text of a foreign file, and what that cannot hold, a sentence each.

    `beside` are texts of further files in the same folder by their names, in which {stem} is that of the file.
    """

    text: str
    notes: tuple[str, ...] = ()
    beside: Mapping[str, str] = field(default_factory=dict)
