"""A phase plane from its JSON, as it was: it holds what is drawn, and no equations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.plane.cycles import Cycle
from contin.plane.flights import Flight
from contin.plane.portrait import PhasePlane
from contin.plane.rest import Rest
from contin.plane.separatrices import Separatrix
from contin.records import Record

_NUMBERS: Final = {"type": "array", "items": {"type": ["number", "null"]}}
_PAIRS: Final = {"type": "array", "items": {**_NUMBERS, "minItems": 2, "maxItems": 2}}
_DRAWN: Final = {"type": "object", "required": ["points"], "properties": {"points": _PAIRS}}
SHAPE: Final = {
    "type": "object",
    "required": [
        "model", "x", "y", "parameters", "held", "window", "equilibria", "nullclines", "separatrices", "cycles",
        "trajectories", "notes", "field",
    ],
    "properties": {
        "model": {"type": "string"}, "x": {"type": "string"}, "y": {"type": "string"},
        "parameters": {"type": "object", "additionalProperties": {"type": "number"}}, "held": {"type": "object"},
        "window": {**_PAIRS, "minItems": 2, "maxItems": 2},
        "equilibria": {"type": "array", "items": {
            "type": "object", "required": ["values", "type", "stability", "eigenvalues"],
            "properties": {"type": {"type": "string"},
                           "stability": {"enum": ["stable", "unstable", "saddle", "neutral"]},
                           "values": {"type": "object", "additionalProperties": {"type": "number"}},
                           "eigenvalues": _PAIRS},
        }},
        "nullclines": {"type": "object", "additionalProperties": {"type": "array", "items": _PAIRS}},
        "separatrices": {"type": "array", "items": {**_DRAWN, "required": ["of", "kind", "end", "points"]}},
        "cycles": {"type": "array", "items": {**_DRAWN, "required": ["period", "multiplier", "points"]}},
        "trajectories": {"type": "array", "items": {**_DRAWN, "required": ["end", "points"]}},
        "notes": {"type": "array", "items": {"type": "string"}},
        "field": {
            "type": "object", "required": ["title", "map", "periods", "units", "arrows"],
            "properties": {"title": {"type": "string"}, "map": {"type": "boolean"}, "periods": _NUMBERS,
                           "units": {"type": "object"}, "arrows": _PAIRS},
        },
    },
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class StoredField:
    """What is shown of a field: names, title, units, directions at the arrows; `PlanarField` computes these."""

    names: tuple[str, str]
    name: str
    title: str
    is_map: bool
    periods: Array
    parameters: dict[str, float]
    held: Mapping[str, float]
    units: Mapping[str, str]
    arrows: Array

    def motion(self, points: Array) -> Array:
        """At the places of the arrows."""
        return self.arrows if len(self.arrows) == len(points) else np.full((len(points), 2), np.nan)


def plane_of(document: Record) -> PhasePlane:
    """The plane of a document that follows `SHAPE`."""
    said, names = document["field"], (document["x"], document["y"])
    field = StoredField(
        names, document["model"], said["title"], said["map"], np.array(said["periods"], dtype=float),
        dict(document["parameters"]), dict(document["held"]), dict(said["units"]), _points(said["arrows"]),
    )  # fmt: skip
    rests = tuple(
        Rest(
            np.array([one["values"][name] for name in names]), np.array([complex(*v) for v in one["eigenvalues"]]),
            np.empty((2, 0), complex), one["type"], one["stability"],
        )
        for one in document["equilibria"]
    )  # fmt: skip
    first, second = (tuple(_points(curve) for curve in document["nullclines"][name]) for name in names)
    return PhasePlane(
        field, np.array(document["window"], dtype=float), (first, second), rests,
        tuple(Separatrix(s["of"], s["kind"], _flight(s, -1 if s["kind"] == "stable" else 1))
              for s in document["separatrices"]),
        tuple(Cycle(_points(c["points"]), c["period"], c["multiplier"]) for c in document["cycles"]),
        tuple(_flight(f, 1) for f in document["trajectories"]), tuple(document["notes"]),
    )  # fmt: skip


def _flight(stored: Record, sense: int) -> Flight:
    return Flight(_points(stored["points"]), sense, stored["end"], stored.get("to"))


def _points(pairs: object) -> Array:
    return np.array(pairs, dtype=float).reshape(-1, 2)
