"""From branches (or a JSON document of them) to what a picture shows: portions of curve by stability, and markers.

Pure data, no drawing: matplotlib and the interactive viewer draw the same `Panel`s.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation.branch import Branch
from contin.continuation.spectra import spectral_columns
from contin.errors import InputError
from contin.model.advice import closest
from contin.plot.typeset import axis_label
from contin.plot.vocabulary import branch_words
from contin.records import Record


@dataclass(frozen=True)
class Mark:
    """A labelled row of a branch."""

    label: str
    type: str
    index: int
    note: str = ""  # criticality or case, in words
    values: Mapping[str, float] = field(default_factory=dict)
    normal_form: Record = field(default_factory=dict)
    spectrum: Vector = field(default_factory=lambda: np.empty(0))
    orbit: Record | None = None  # time and states over a period, where a file has them


@dataclass(frozen=True, eq=False)
class Source:
    """What the plots need to know of a branch, whether it comes from memory or from a file."""

    name: str
    kind: str
    locus: str | None
    parameters: tuple[str, ...]
    columns: Mapping[str, Vector]
    marks: tuple[Mark, ...]
    image_of: str | None = None
    forced: bool = False  # the responses of a forced flow
    multipliers: bool = False  # spectra are those of orbits or maps


@dataclass(frozen=True, eq=False)
class Portion:
    """A run of one stability (None on loci, where stability is not drawn); `rows` are the branch's row numbers."""

    x: Array
    y: Array
    stable: bool | None
    rows: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Curve:
    """One branch in one panel; orbits have two strands (maximum and minimum), cycles of maps one an iterate."""

    name: str
    kind: str
    locus: str | None
    portions: tuple[Portion, ...]
    marks: tuple[tuple[float, float, Mark], ...]
    strands: int
    words: str  # what its points are


@dataclass(frozen=True, eq=False)
class Panel:
    """Curves that share their axes."""

    x: str
    y: str
    x_label: str
    y_label: str
    curves: tuple[Curve, ...]


def from_branches(branches: Iterable[Branch], spectra: bool = False) -> list[Source]:
    """Sources of branches in memory, with their eigenvalues as columns if `spectra`."""
    return [
        Source(
            branch.name,
            branch.kind,
            branch.locus,
            tuple(branch.parameters),
            {**branch.columns, **spectral_columns(branch)} if spectra else branch.columns,
            tuple(
                Mark(
                    point.label,
                    point.type,
                    int(point.index),
                    _note(point.normal_form),
                    point.values,
                    point.normal_form,
                    point.eigenvalues,
                )
                for point in branch.points
            ),
            branch.image_of.branch if branch.image_of else None,
            bool(getattr(getattr(branch.problem, "system", None), "is_forced", False)),
            branch.multiplier_kind,
        )
        for branch in branches
    ]


def from_document(document: Record) -> list[Source]:
    """Sources of the branches of a JSON result.

    Raises
    ------
    InputError
        A branch lacks what a picture needs.
    """
    try:
        forced = bool(document.get("model", {}).get("forced"))
        return [_from_json(branch, forced) for branch in document["branches"]]
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise InputError(f"the document is not a contin result of format 1: {error!r} in a branch") from None


def _from_json(branch: Record, forced: bool) -> Source:
    columns = {
        str(name): np.array(column, dtype=bool if name == "stable" else float)  # None becomes NaN
        for name, column in branch["columns"].items()
    }
    rows = {len(column) for column in columns.values()}
    if len(rows) > 1:
        raise ValueError(f"branch {branch['name']!r} has columns of different lengths")
    marks = tuple(
        Mark(
            point["label"],
            point["type"],
            int(point["index"]),
            _note(point["normal_form"]),
            point["values"],
            point["normal_form"],
            _spectrum(point),
            point.get("orbit"),
        )
        for point in branch["points"]
    )
    if any(not 0 <= mark.index < max(rows, default=0) for mark in marks):
        raise IndexError(f"branch {branch['name']!r} has a point outside its rows")
    image = branch.get("image_of")
    parameters = tuple(branch["parameters"])
    return Source(
        branch["name"], branch["kind"], branch["locus"], parameters, columns, marks,
        image["branch"] if image else None, forced, any("multipliers" in point for point in branch["points"]),
    )  # fmt: skip


def _spectrum(point: Record) -> Vector:
    pairs = point.get("multipliers", point.get("eigenvalues")) or []
    return np.array([complex(*(np.nan if v is None else v for v in pair)) for pair in pairs], dtype=complex)


def _note(normal_form: Record) -> str:
    return " ".join(str(normal_form[key]) for key in ("criticality", "kind", "case") if normal_form.get(key))


def panels(
    sources: Sequence[Source],
    *,
    x: str | None = None,
    y: str | Sequence[str] | None = None,
    periods: Mapping[str, float] | None = None,
    units: Mapping[str, str] | None = None,
) -> list[Panel]:
    """Group the branches into panels of common axes.

    Branches in one parameter are drawn over it (one panel for each parameter that was varied), loci in the plane of
    their two parameters. `x` and `y` choose columns instead; then there is one panel with every branch that has both.

    Parameters
    ----------
    sources : sequence of Source
    x : str, optional
    y : str or sequence of str, optional
        Columns; `y` may be a state or observable `s` where orbits have `s.min` and `s.max` (both strands are drawn),
        or several, for a panel each.
    periods : mapping, optional
        Period of each angle: it is drawn in [-period/2, period/2), broken where it wraps.
    units : mapping, optional
        Units of parameters, states and observables, for the axes.

    Raises
    ------
    InputError
        No branch has the columns asked for.
    """
    if y is not None and not isinstance(y, str):
        return [panel for name in y for panel in panels(sources, x=x, y=name, periods=periods, units=units)]
    periods, units = periods or {}, units or {}
    groups: dict[tuple[str, str], list[Curve]] = {}
    default_y = y or _default_ordinate(sources)
    for source in sources:
        two = len(source.parameters) > 1
        abscissa = x or source.parameters[0]
        ordinate = y or (source.parameters[1] if two and x in (None, source.parameters[0]) else default_y)
        if two and ordinate not in source.parameters and _flat(sources):
            continue  # the projection of a curve in two parameters says nothing beside branches in one
        curve = _curve(source, abscissa, ordinate, periods)
        if curve is not None:
            groups.setdefault((abscissa, ordinate), []).append(curve)
    if not groups:
        known = sorted({name for source in sources for name in ordinates(source)})
        wrong = next((name for name in (x, default_y) if name is not None and name not in known), default_y)
        advice = closest(wrong, known)
        raise InputError(
            f"no branch has columns for x = {x or 'its parameter'}, y = {default_y}"
            f"{': ' + advice if advice else ''}; columns: {', '.join(known)}"
        )
    return [
        Panel(a, b, axis_label(a, units), axis_label(b, units, _meaning(b) or _strands(curves)), tuple(curves))
        for (a, b), curves in groups.items()
    ]


def _meaning(name: str) -> str:
    return {"eigenvalues": ", real parts", "multipliers": ", moduli"}.get(name, "")


def _strands(curves: Sequence[Curve]) -> str:
    two = {curve.kind for curve in curves if curve.strands == 2}
    named = [words for kind, words in (("orbit", "orbits"), ("torus", "tori")) if kind in two]
    return f", {' and '.join(named)}: max and min" if named else ""


def _flat(sources: Sequence[Source]) -> bool:
    """Whether some branch is in one parameter."""
    return any(len(source.parameters) == 1 for source in sources)


def ordinates(source: Source) -> list[str]:
    """Names that can stand on an axis: columns, with `s.min` and `s.max` counted as `s`."""
    return list(dict.fromkeys(name.removesuffix(".min").removesuffix(".max") for name in source.columns))


def _default_ordinate(sources: Sequence[Source]) -> str:
    """The first state that varies on some branch; the period, which follows a forcing, only where no state does.

    Of the responses to a forcing, their amplitude.
    """
    if all(source.forced and "amplitude" in source.columns for source in sources):
        return "amplitude"
    names = [
        name
        for source in sources
        for name in ordinates(source)
        if name not in source.parameters and name not in ("stable", "unstable")
    ]
    if not names:
        raise InputError("there is nothing to plot: no branch has a state column")
    for name in sorted(dict.fromkeys(names), key=lambda name: name == "period"):
        strands = [strand for source in sources for strand in _columns(source, name)]
        if strands and not is_constant(np.concatenate(strands)):
            return name
    return names[0]


def is_constant(values: Array) -> bool:
    """True where the values differ by rounding only: a picture must not blow that up."""
    finite = values[np.isfinite(values)]
    if not len(finite):
        return True
    return float(np.ptp(finite)) <= max(1e-9 * float(np.max(np.abs(finite))), 1e-15)


def _columns(source: Source, name: str) -> list[Array]:
    """The strands of a name: its column (of a cycle of a map: every iterate), or maximum and minimum of each orbit."""
    iterates = [key for key in source.columns if key.startswith(f"{name}.") and key[len(name) + 1 :].isdigit()]
    if name in source.columns and iterates:
        return [np.asarray(source.columns[key], float) for key in iterates]
    if name in source.columns:
        return [np.asarray(source.columns[name], float)]
    if f"{name}.max" in source.columns and f"{name}.min" in source.columns:
        return [np.asarray(source.columns[f"{name}.max"], float), np.asarray(source.columns[f"{name}.min"], float)]
    return []


def _curve(source: Source, x: str, y: str, periods: Mapping[str, float]) -> Curve | None:
    xs, strands = _columns(source, x), _columns(source, y)
    if not xs or not strands or not len(xs[0]):
        return None
    abscissa = wrapped(xs[0], periods.get(x))
    portions: list[Portion] = []
    for strand in strands:
        ordinate = wrapped(strand, periods.get(y))
        jumps = _jumps(abscissa, periods.get(x)) | _jumps(ordinate, periods.get(y))
        portions += _portions(source, abscissa, ordinate, jumps)
    top = wrapped(strands[0], periods.get(y))
    marks = tuple((float(abscissa[mark.index]), float(top[mark.index]), mark) for mark in source.marks)
    words = branch_words(source.kind, source.locus, source.columns)
    return Curve(source.name, source.kind, source.locus, tuple(portions), marks, len(strands), words)


def wrapped(values: Array, period: float | None) -> Array:
    """The angle in [-period/2, period/2); a constant half period stays on one side instead of flickering."""
    if period is None:
        return values
    half = period / 2
    wrapped = (values + half) % period - half
    edge = np.abs(np.abs(wrapped) - half) < 1e-9 * period
    return np.where(edge, half, wrapped)


def _jumps(values: Array, period: float | None) -> NDArray[np.bool_]:
    """True between rows i and i + 1 where the angle wraps."""
    if period is None:
        return np.zeros(max(len(values) - 1, 0), bool)
    return np.abs(np.diff(values)) > period / 2


def _portions(source: Source, x: Array, y: Array, jumps: NDArray[np.bool_]) -> list[Portion]:
    """Cut the curve where stability changes, where an angle wraps, and at gaps (NaN)."""
    if len(x) == 1:
        return [Portion(x, y, None, np.zeros(1, np.int64))]
    stable = segment_stability(source)
    gaps = jumps | ~np.isfinite(x[:-1] + y[:-1] + x[1:] + y[1:])
    portions = []
    first = 0
    for row in range(1, len(x)):
        last_segment = row == len(x) - 1
        cut = last_segment or gaps[row - 1] or gaps[row] or (stable is not None and stable[row] != stable[row - 1])
        if cut:
            if not gaps[row - 1]:
                rows = np.arange(first, row + 1)
                portions.append(Portion(x[rows], y[rows], None if stable is None else bool(stable[row - 1]), rows))
            first = row
    return portions


def segment_stability(source: Source) -> NDArray[np.bool_] | None:
    """Stability between rows i and i + 1; labelled rows do not count critical eigenvalues: their neighbours decide."""
    if source.kind == "locus" or "stable" not in source.columns:
        return None
    flags = np.asarray(source.columns["stable"], bool)
    labelled = np.zeros(len(flags), bool)
    labelled[[mark.index for mark in source.marks if mark.type != "UZ"]] = True
    left, right = flags[:-1], flags[1:]
    both = left & right
    return np.where(labelled[:-1] & ~labelled[1:], right, np.where(labelled[1:] & ~labelled[:-1], left, both))
