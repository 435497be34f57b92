"""XML files: refused with entities and external definitions; the root element says which reader they are for."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path
from typing import Final

from contin.errors import InputError
from contin.exchange.imported import Imported

READERS: Final = {  # module with a function `read` by the root element
    "sbml": "contin.exchange.sbml.reader",
    "model": "contin.exchange.cellml.reader",
}
_ROOT: Final = re.compile(r"<\s*(?:[\w.-]+:)?([A-Za-z_][\w.-]*)[\s/>]")
_SKIPPED: Final = re.compile(r"<\?.*?\?>|<!--.*?-->", re.DOTALL)
_DECLARED: Final = re.compile(r"\A\s*<\?xml[^>]*\?>")


def read(text: str, path: Path) -> Imported:
    """The model in an XML file of any known kind."""
    kind = root(text, path)
    if kind not in READERS:
        raise InputError(f"{path}: the root element is <{kind}>; known are {', '.join(f'<{k}>' for k in READERS)}")
    found: Imported = import_module(READERS[kind]).read(check(text, path), path)
    return found


def root(text: str, path: Path) -> str:
    """The name of the root element without its prefix."""
    check(text, path)
    match = _ROOT.search(_SKIPPED.sub("", text[:100_000]))
    if match is None:
        raise InputError(f"{path}: is not XML: no element is found")
    return match.group(1)


def check(text: str, path: Path) -> str:
    """The text without its XML declaration (it is decoded already); InputError for one with definitions of its own."""
    bare = _SKIPPED.sub("", text)
    if "<!DOCTYPE" in bare or "<!ENTITY" in bare:
        raise InputError(f"{path}: has a document type declaration (<!DOCTYPE ...>); remove it")
    return _DECLARED.sub("", text, count=1)
