"""Antimony, a text format for SBML models: through the SBML that the package antimony makes of it."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Final

import antimony

from contin.errors import InputError
from contin.exchange.imported import Imported, UnsupportedError
from contin.exchange.sbml.reader import read as read_sbml

_IMPORT: Final = re.compile(r"^\s*import\s+\"", re.M)  # of another file


def read(text: str, path: Path) -> Imported:
    """The main model of an Antimony text; files that it imports are not read."""
    if _IMPORT.search(text):
        raise UnsupportedError(f"{path}: `import` of other files is not supported; put the models into one file")
    antimony.clearPreviousLoads()
    try:
        if antimony.loadAntimonyString(text) < 0:
            raise InputError(f"{path}: {_first(antimony.getLastError())}")
        found = read_sbml(antimony.getSBMLString(antimony.getMainModuleName()), path)
        warned = antimony.getWarnings()
    finally:
        antimony.clearPreviousLoads()
    notes = tuple(line.strip() for line in (warned or "").splitlines() if line.strip())
    name = antimony_name(str(found.model["name"]), path)
    return replace(found, model={**found.model, "name": name}, notes=(*notes, *found.notes))


def antimony_name(name: str, path: Path) -> str:
    """The model's name; that of the file where the text names none."""
    return path.stem if name in ("__main", "doc__main") or not name else name


def _first(message: str | None) -> str:
    return " ".join((message or "is not an Antimony model").split())
