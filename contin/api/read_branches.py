"""Branches and their labelled points from a result document: numbers, spectra, orbits, ways to solutions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from contin.abi import Vector
from contin.continuation.branch import ERROR_OF, Branch, End, ImageOf, Parent, SpecialPoint
from contin.continuation.stored_problem import StoredProblem
from contin.records import Record
from contin.store.solutions import Solutions


def branch_of(stored: Record, document: Record, solutions: Solutions | None) -> Branch:
    """One branch of a document; `solutions`, of a file that holds them."""
    columns = {str(name): _column(name, column) for name, column in stored["columns"].items()}
    rows = len(next(iter(columns.values()), ()))
    parent, image = stored["parent"], stored["image_of"]
    nothing, kept = np.empty((rows, 0)), stored.get("rows", {})
    spectra = np.array([_complex(row) for row in kept.get("eigenvalues", ())]) if kept.get("eigenvalues") else nothing
    head = f"{stored['name']}: "
    return Branch(
        name=stored["name"], kind=stored["kind"], parameters=tuple(stored["parameters"]), columns=columns,
        points=tuple(_point(stored, point, solutions) for point in stored["points"]),
        ends=(_end(stored["ends"][0]), _end(stored["ends"][1])), z=nothing, tangents=nothing,
        eigenvalues=spectra.astype(complex), start_row=kept.get("start", 0), steps=stored["steps"],
        seconds=stored["seconds"], effort=stored.get("effort", {}), problem=None, locus=stored["locus"],
        parent=None if parent is None else Parent(parent["branch"], parent["label"]),
        image_of=None if image is None else ImageOf(image["branch"], image["symmetry"]),
        notes=tuple(note.removeprefix(head) for note in document["notes"] if note.startswith(head)),
        free=tuple(stored.get("free", ())), described=document["model"],
        kept={one["row"]: _orbit(one["orbit"]) for one in kept.get("orbits", ())},
    )  # fmt: skip


def _orbit(columns: Mapping[str, Sequence[float | None]]) -> dict[str, Vector]:
    return {name: np.array(column, dtype=float) for name, column in columns.items()}


def _column(name: str, column: list[float | None]) -> Vector:
    kind = bool if name in ("stable", "neutral") else int if name == "unstable" else float  # null becomes NaN
    return np.array(column, dtype=float if None in column else kind)


def _point(branch: Record, stored: Record, solutions: Solutions | None) -> SpecialPoint:
    where = f"{branch['name']}.{stored['label']}"
    solution = None
    if solutions is not None:
        solution = partial(solutions.point, branch["name"], stored["label"], where)
    problem = StoredProblem(branch["kind"], tuple(branch["parameters"]), where, stored.get("orbit"), solution)
    errors = {name: _number(error) for name, error in stored.get("errors", {}).items()}
    known = dict(zip(("second",), (errors[n] for n in branch["parameters"][1:2] if n in errors), strict=False))
    known |= {f"{ERROR_OF}{name}": error for name, error in errors.items() if name not in branch["parameters"]}
    return SpecialPoint(
        type=stored["type"], label=stored["label"], index=stored["index"], z=np.empty(0), tangent=np.empty(0),
        values={name: _number(value) for name, value in stored["values"].items()},
        residual=_number(stored["residual"]), error=_number(stored["error"]),
        eigenvalues=_complex(stored.get("multipliers", stored.get("eigenvalues", []))),
        normal_form=stored["normal_form"], also=tuple(filter(None, stored.get("also", "").split(", "))),
        branch=branch["name"], problem=problem, vectors=known,
    )  # fmt: skip


def _end(stored: Record) -> End:
    return End(stored["reason"], stored["text"], {k: v for k, v in stored.items() if k not in ("reason", "text")})


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


def _complex(pairs: list[list[float | None]]) -> NDArray[np.complex128]:
    return np.array([complex(_number(re), _number(im)) for re, im in pairs], dtype=complex)
