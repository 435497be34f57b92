"""AUTO's file of constants: the few that say what kind of problem it is, and its range."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

_PAIR: Final = re.compile(r"(\w+)\s*=\s*(\{[^}]*\}|\[[^\]]*\]|'[^']*'|\"[^\"]*\"|[^\s,]+)")
_ENTRY: Final = re.compile(r"['\"]?(-?\w+)['\"]?\s*:\s*(\[[^\]]*\]|['\"][^'\"]*['\"]|[^\s,{}]+)")
_OLD: Final = re.compile(r"\s*(-?\d+)\s+(-?\d+)\s+(-?\d+)\s+(-?\d+)\s+(?:NDIM|[A-Z ,]*NDIM)", re.IGNORECASE)
LARGEST: Final = 1_000_000  # characters


@dataclass
class Constants:
    """What a file says; `known` is False without one."""

    known: bool = False
    numbers: dict[str, float] = field(default_factory=dict)  # by their names in small letters
    states: dict[int, str] = field(default_factory=dict)
    parameters: dict[int, str] = field(default_factory=dict)
    free: list[str] = field(default_factory=list)
    stops: dict[str, list[float]] = field(default_factory=dict)

    @property
    def kind(self) -> int:
        """IPS: -1 maps, 0 algebraic, 1 and 2 flows, 4 boundary values, 9 connections."""
        return int(self.numbers.get("ips", 1))


def beside(path: Path) -> Constants:
    """The constants in c.NAME (or NAME.c) beside NAME.f90."""
    for name in (f"c.{path.stem}", f"{path.stem}.c", f"c.{path.stem}.1"):
        place = path.parent / name
        if place.is_file() and place.stat().st_size <= LARGEST:
            return constants(place.read_text(errors="replace"))
    return Constants()


def constants(text: str) -> Constants:
    """The constants of a file, in AUTO's new form (NAME = value) or the first line of the old one."""
    bare = "\n".join(re.split(r"[#!]", line)[0] for line in text.splitlines())
    found = Constants(known=True)
    old = _OLD.match(text)
    if old is not None:
        found.numbers = {"ndim": float(old[1]), "ips": float(old[2])}
    for name, value in _PAIR.findall(bare):
        key = name.lower()
        if key in ("unames", "parnames"):
            entries = {int(k): v.strip("'\"") for k, v in _ENTRY.findall(value) if k.isdigit()}
            (found.states if key == "unames" else found.parameters).update(entries)
        elif key == "icp":
            found.free = re.findall(r"\w+", value)
        elif key in ("uzr", "uzstop"):
            for entry, ends in _ENTRY.findall(value):
                found.stops.setdefault(entry.lstrip("-"), []).extend(_numbers(ends))
        else:
            numbers = _numbers(value)
            if len(numbers) == 1 and not value.startswith(("{", "[")):
                found.numbers[key] = numbers[0]
    return found


def _numbers(text: str) -> list[float]:
    found = re.findall(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?", text)
    return [float(n.lower().replace("d", "e")) for n in found]
