"""Results read back from the files that contin writes: branches with columns, points and orbits.

A `.contin` file holds the equations too, and the points as they were computed: runs start from them as in the session
that wrote them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Vector
from contin.continuation.branch import Branch, End, ImageOf, Parent, SpecialPoint
from contin.continuation.stored import StoredProblem
from contin.errors import InputError
from contin.plot.figure import draw
from contin.plot.look import Look
from contin.plot.scan import drawn as drawn_scan
from contin.records import Record
from contin.store.digest import mistake
from contin.store.json_format import read_mapping
from contin.store.places import ending_of
from contin.store.results import read_results
from contin.store.scan_store import read_scan
from contin.store.solution_tables import load_solutions
from contin.store.solutions import Solutions

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Results:
    """The branches of a result file in their order, by name; `notes` in words; `document`, all that the file says."""

    branches: tuple[Branch, ...]
    notes: tuple[str, ...]
    document: Record

    def __iter__(self) -> Iterator[Branch]:
        return iter(self.branches)

    def __len__(self) -> int:
        return len(self.branches)

    def __getitem__(self, name: str) -> Branch:
        for branch in self.branches:
            if branch.name == name:
                return branch
        known = ", ".join(branch.name for branch in self.branches) or "none"
        raise KeyError(f"no branch {name!r}; branches: {known}")

    def plot(self, ax: Axes | None = None, **options: object) -> Figure:
        """A matplotlib figure, as that of the diagram or branches that were saved; options: `contin.plot.look.Look`."""
        return draw(self.branches, ax=ax, look=Look.of(options))


@dataclass(frozen=True, eq=False)
class ScanResults(Results):
    """The runs of a scan, finished or not, as they were stored: a table, a row a run; it has no branches."""

    @property
    def columns(self) -> Mapping[str, Sequence[Any]]:
        """Axes, start, class, outcome, time, statistics of the runs."""
        found: Mapping[str, Sequence[Any]] = self.document["columns"]
        return found

    @property
    def counts(self) -> dict[str, int]:
        """How many runs of each class, the most frequent first."""
        return dict(Counter(self.columns["class"]).most_common())

    def plot(self, ax: Axes | None = None, **options: object) -> Figure:
        """Classes over one or two axes, a panel a start.

        options : x, y, limits, log, size, legend, title, style; `start`, to draw this one alone (into `ax`).
        """
        return drawn_scan(dict(self.document), ax, options)


def read(file: str | Path) -> Results:
    """The results in a `.contin` or `.json` file: `contin.read(file)[branch][label]`; of a `.scan` its table of runs.

    Columns, points, values, eigenvalues, normal forms and ends are those that were saved; `point.orbit` where the file
    keeps it. From the points of a `.contin` file branches are followed: `point.switch()`, `point.locus()`. InputError
    for any other file.
    """
    path = Path(file)
    runs = _scan(path)
    if runs is not None:
        return ScanResults((), tuple(runs.get("notes", ())), runs)
    document = read_results(path)
    solutions = load_solutions(path) if ending_of(path) == ".contin" else None
    branches = tuple(_branch(branch, solutions) for branch in document["branches"])
    return Results(branches, tuple(document.get("notes", ())), document)


def _scan(path: Path) -> Record | None:
    """The document of a scan, from its store or from JSON; None for any other file."""
    if ending_of(path) == ".scan":
        return read_scan(path)
    if ending_of(path) != ".json":
        return None
    document = read_mapping(path)
    if "branches" in document or not {"scan", "columns"} <= set(document):
        return None
    wrong = mistake(document)
    columns = document["columns"]
    if not isinstance(columns, dict) or not isinstance(columns.get("class"), list):
        raise InputError(f"{path}: not the results of a scan, or damaged")
    return document if wrong is None else {**document, "notes": [f"{path.name} {wrong}"]}


def _branch(stored: Record, solutions: Solutions | None) -> Branch:
    columns = {str(name): _column(name, column) for name, column in stored["columns"].items()}
    rows = len(next(iter(columns.values()), ()))
    parent, image = stored["parent"], stored["image_of"]
    nothing = np.empty((rows, 0))
    return Branch(
        name=stored["name"], kind=stored["kind"], parameters=tuple(stored["parameters"]), columns=columns,
        points=tuple(_point(stored, point, solutions) for point in stored["points"]),
        ends=(_end(stored["ends"][0]), _end(stored["ends"][1])), z=nothing, tangents=nothing,
        eigenvalues=nothing.astype(complex), start_row=0, steps=stored["steps"], seconds=stored["seconds"],
        effort=stored.get("effort", {}), problem=None, locus=stored["locus"],
        parent=None if parent is None else Parent(parent["branch"], parent["label"]),
        image_of=None if image is None else ImageOf(image["branch"], image["symmetry"]),
        free=tuple(stored.get("free", ())),
    )  # fmt: skip


def _column(name: str, column: list[float | None]) -> Vector:
    kind = bool if name in ("stable", "neutral") else int if name == "unstable" else float  # null becomes NaN
    return np.array(column, dtype=float if None in column else kind)


def _point(branch: Record, stored: Record, solutions: Solutions | None) -> SpecialPoint:
    where = f"{branch['name']}.{stored['label']}"
    solution = None
    if solutions is not None:
        solution = partial(solutions.point, branch["name"], stored["label"], where)
    problem = StoredProblem(branch["kind"], tuple(branch["parameters"]), where, stored.get("orbit"), solution)
    errors = [_number(stored["errors"][n]) for n in branch["parameters"][1:2] if n in stored.get("errors", {})]
    return SpecialPoint(
        type=stored["type"], label=stored["label"], index=stored["index"], z=np.empty(0), tangent=np.empty(0),
        values={name: _number(value) for name, value in stored["values"].items()},
        residual=_number(stored["residual"]), error=_number(stored["error"]),
        eigenvalues=_complex(stored.get("multipliers", stored.get("eigenvalues", []))),
        normal_form=stored["normal_form"], also=tuple(filter(None, stored.get("also", "").split(", "))),
        branch=branch["name"], problem=problem, vectors=dict(zip(("second",), errors, strict=False)),
    )  # fmt: skip


def _end(stored: Record) -> End:
    return End(stored["reason"], stored["text"], {k: v for k, v in stored.items() if k not in ("reason", "text")})


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


def _complex(pairs: list[list[float | None]]) -> NDArray[np.complex128]:
    return np.array([complex(_number(re), _number(im)) for re, im in pairs], dtype=complex)
