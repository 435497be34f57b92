"""JSON of single commands (`contin simulate`, `sweep`, `lyapunov`, `survey`, `scan`): what it is of, and its shape."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from contin.errors import FormatVersionError, InputError
from contin.records import Fields, Record
from contin.store.digest import KEY, mistake
from contin.store.json_format import FORMAT_VERSION
from contin.store.validate import first_mistake

_NUMBER: Final = {"type": ["number", "null"]}
_NUMBERS: Final = {"type": "array", "items": _NUMBER}
_TEXTS: Final = {"type": "array", "items": {"type": "string"}}
_TABLE: Final = {"type": "object", "required": ["t"], "additionalProperties": _NUMBERS}
_SIDE: Final = {f"{side}{part}": _TEXTS for side in ("below", "above") for part in (".type", ".detail", ".end")}

SHAPES: Final[dict[str, Fields]] = {
    "simulation": {
        "type": "object",
        "required": ["model", "outcome", "why", "end_time", "columns"],
        "properties": {
            "model": {"type": "string"}, "method": {"type": "string"}, "outcome": {"type": "string"},
            "why": {"type": "string"}, "end_time": _NUMBER, "columns": _TABLE, "section": _TABLE,
            "events": {**_TABLE, "required": ["t", "event"]},
        },
    },
    "sweep": {
        "type": "object",
        "required": ["model", "sweep", "columns"],
        "properties": {
            "model": {"type": "string"}, "sweep": {"type": "string"},
            "columns": {
                "type": "object", "required": ["direction", "outcome"], "properties": {"outcome": _TEXTS},
                "additionalProperties": _NUMBERS,
            },
        },
    },
    "lyapunov": {
        "type": "object",
        "required": ["model", "lyapunov", "complete", "notes", "columns"],
        "properties": {
            "model": {"type": "string"}, "lyapunov": {"type": "string"}, "complete": {"type": "boolean"},
            "notes": _TEXTS,
            "columns": {
                "type": "object", "required": ["exponent.1", "error.1", "time", "outcome"],
                "properties": {"outcome": _TEXTS}, "additionalProperties": _NUMBERS,
            },
        },
    },
    "survey": {
        "type": "object",
        "required": ["model", "factor", "survey", "attractors", "notes", "seconds"],
        "properties": {
            "model": {"type": "string"}, "factor": {"type": "number"}, "seconds": {"type": "number"}, "notes": _TEXTS,
            "attractors": {"type": "object", "additionalProperties": {
                "type": "object", "required": ["solution", "how", "words"], "additionalProperties": {"type": "string"},
            }},
            "survey": {
                "type": "object", "required": ["attractor", "parameter", "value", "below", "above", *_SIDE],
                "properties": {"attractor": _TEXTS, "parameter": _TEXTS, **_SIDE}, "additionalProperties": _NUMBERS,
            },
        },
    },
    "scan": {
        "type": "object",
        "required": ["model", "scan", "columns"],
        "properties": {
            "model": {"type": "object"},
            "scan": {"type": "object", "required": ["axes", "starts", "classes"], "properties": {
                "axes": {"type": "object", "additionalProperties": _NUMBERS}, "starts": _TEXTS,
                "classes": {"type": "object"},
            }},
            "columns": {
                "type": "object", "required": ["start", "class", "outcome"],
                "properties": {"start": _TEXTS, "class": _TEXTS, "outcome": _TEXTS}, "additionalProperties": _NUMBERS,
            },
        },
    },
}  # fmt: skip
_TABLES: Final = {"simulation": ("columns", "section", "events"), "sweep": ("columns",), "survey": ("survey",)}


def kind_of(document: Record) -> str | None:
    """simulation, sweep, lyapunov, survey, scan, plane or planes; None for results with branches, and for others."""
    if "branches" in document:
        return None
    if document.get("kind") in ("plane", "planes"):
        return str(document["kind"])
    for kind in ("survey", "sweep", "lyapunov", "scan"):
        if kind in document:
            return kind
    return "simulation" if {"end_time", "outcome", "columns"} <= set(document) else None


def checked(document: Record, kind: str, path: Path, shape: Record | None = None) -> Fields:
    """The document of this kind, with a note where its `sha256` is absent or wrong; InputError where it is none.

    shape : of a kind that another room knows.
    """
    version = document.get("contin")
    if isinstance(version, bool) or not isinstance(version, int) or version > FORMAT_VERSION:
        raise FormatVersionError(f"{path}: written in format {version}; this contin reads up to {FORMAT_VERSION}")
    where = first_mistake(document, SHAPES[kind] if shape is None else shape)
    if where is None:
        for name in _TABLES.get(kind, ("columns",)):
            if len({len(column) for column in document.get(name, {}).values()}) > 1:
                where = f"{name} has columns of different lengths"
    if where is not None:
        raise InputError(f"{path}: not the results of a {kind}, or damaged: {where}")
    wrong = mistake(document)
    found = {key: value for key, value in document.items() if key != KEY}
    return found if wrong is None else {**found, "notes": [*found.get("notes", []), f"{path.name} {wrong}"]}
