"""JSON results, format version 1: a plain document of the results, ready for any language.

The layout is a contract that outside scripts rely on; it is extended by new optional keys only.
"""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.continuation.branch import Branch, End, SpecialPoint
from contin.errors import FormatVersionError, InputError
from contin.records import Fields, Json, Record
from contin.store.atomic import write_text
from contin.store.built import built
from contin.store.digest import KEY, DamageWarning, mistake, signed
from contin.store.validate import validate

if TYPE_CHECKING:
    from contin.model.model import Model

FORMAT_VERSION: Final = 1
LINE: Final = json.JSONEncoder(allow_nan=False, ensure_ascii=False)

OrbitSampler = Callable[[Branch, SpecialPoint], Record | None]
"""Gives {'orbit': {'t': .., state: ..}} (or {'fields': ..}) at a point, or None where the point has neither."""

RowSampler = Callable[[Branch], Record]
"""Gives `eigenvalues` and `orbits` of the rows of a branch."""


def result_document(
    model: Record,
    branches: Iterable[Branch],
    *,
    timing: Mapping[str, float],
    notes: Sequence[str] = (),
    orbit: OrbitSampler | None = None,
    phase: Record | None = None,
    simulated: Record | None = None,
    diagram: Record | None = None,
    rows: RowSampler | None = None,
) -> Fields:
    """The results of a run as nested dicts, lists, numbers and strings only.

    Parameters
    ----------
    model : mapping
        `name`, `states` and `parameters` (the values the run started from), and optional keys such as `units`.
    branches : iterable of Branch
        In the order they were computed.
    timing : mapping
        Seconds spent in `import`, `lower`, `kernels` and `total`.
    notes : sequence of str
        What did not become a label or a branch, in words; the notes of the branches are appended by name.
    orbit : callable, optional
        Adds the orbit itself to every labelled point that has one.
    phase : mapping, optional
        The regions of a phase diagram, whose curves are among the branches.
    simulated : mapping, optional
        `simulations` (a list) and `sweep`.
    diagram : mapping, optional
        Of a diagram whose branches are among these: `parameter`, `range`, `branches` (names).
    rows : callable, optional
        Adds spectra and orbits of its rows to every branch.
    """
    branches = list(branches)
    written = [branch_document(branch, orbit, rows) for branch in branches]
    of_branches = (f"{branch.name}: {note}" for branch in branches for note in branch.notes if note not in notes)
    every_note = [*notes, *of_branches]
    return {
        "contin": FORMAT_VERSION,
        "model": plain(model),
        "branches": written,
        **({} if diagram is None else {"diagram": plain(diagram)}),
        **({} if phase is None else {"phase": plain(phase)}),
        **({} if simulated is None else plain(simulated)),
        "built": built(),
        "notes": list(dict.fromkeys(every_note)),  # a diagram lists those of its branches too
        "timing": plain(timing),
    }


def branch_document(
    branch: Branch, orbit: OrbitSampler | None = None, rows: RowSampler | None = None
) -> Fields:
    """One branch as in the document."""
    parent, image = branch.parent, branch.image_of
    return {
        "name": branch.name,
        "kind": branch.kind,
        "locus": branch.locus,
        "parameters": list(branch.parameters),
        "parent": None if parent is None else {"branch": parent.branch, "label": parent.label},
        "image_of": None if image is None else {"branch": image.branch, "symmetry": image.symmetry},
        **({"free": list(branch.free)} if branch.free else {}),
        "columns": {name: plain(column) for name, column in branch.columns.items()},
        "points": [_point(branch, point, orbit) for point in branch.points],
        "ends": [_end(end) for end in branch.ends],
        "steps": int(branch.steps),
        "seconds": float(branch.seconds),
        "effort": plain(branch.effort),
        **({} if rows is None else {"rows": plain(rows(branch))}),
    }


def _point(branch: Branch, point: SpecialPoint, orbit: OrbitSampler | None) -> Fields:
    document = {
        "label": point.label,
        "type": point.type,
        "index": int(point.index),
        "values": plain(point.values),
        "residual": plain(point.residual),
        "error": plain(point.error),
        "multipliers" if branch.multiplier_kind else "eigenvalues": plain(np.asarray(point.eigenvalues, complex)),
        "normal_form": plain(point.normal_form),
    }
    if len(point.errors) > 1:
        document["errors"] = plain(point.errors)
    if point.also:
        document["also"] = ", ".join(point.also)
    if orbit is not None and (profile := orbit(branch, point)) is not None:
        document.update(plain(profile))
    return document


def _end(end: End) -> Fields:
    return {"reason": end.reason, "text": end.text, **plain(end.data)}


def describe_model(model: Model, overrides: Record | None = None) -> Fields:
    """The `model` entry: names, parameter values with `overrides`, and what is declared of title, units, angles."""
    described: Fields = {
        "name": model.name,
        "states": list(model.state_names),
        "parameters": model.default_parameters(overrides),
    }
    fields = getattr(model, "fields", ())
    if fields:
        described.update({"fields": list(fields), "axes": list(model.axes), "unknowns": model.n})  # type: ignore[attr-defined]
    if getattr(model, "kind", "flow") != "flow":
        described["kind"] = model.kind
    if getattr(model, "forcing", None) is not None:
        described["forced"] = True
    totals = getattr(model, "totals", ())
    if totals:
        described["conserved"] = {t.name: {"states": list(t.law), "eliminated": t.state.name} for t in totals}
    if model.title:
        described["title"] = model.title
    units = {p.name: p.unit for p in model.parameters if p.unit} | {s.name: s.unit for s in model.states if s.unit}
    if units:
        described["units"] = units
    named = bool(model.state_names)  # a function of very many states gives none, and has no angles
    periods = model.periods(overrides) if named else ()
    angles = {s: float(t) for s, t in zip(model.state_names, periods, strict=True) if t > 0}
    if angles:
        described["periods"] = angles
    return described


def model_of(branches: Sequence[Branch]) -> Fields:
    """The `model` entry of branches in memory, at the parameter values of the first."""
    if not branches:
        raise InputError("there is no branch to draw or to save")
    problem = branches[0].problem
    if problem is None:
        return dict(branches[0].described or {})
    return describe_model(problem.system.model, problem.constants())


def plain(value: object) -> Json:
    """`value` in JSON's own types: arrays as lists, complex numbers as [re, im], NaN and infinity as None."""
    if value is None or isinstance(value, str | bool):
        return value
    if isinstance(value, np.ndarray):
        return _plain_array(value)
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, int):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, complex):
        return [plain(value.real), plain(value.imag)]
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, Iterable):
        return [plain(entry) for entry in value]
    raise TypeError(f"a result holds a {type(value).__name__}, which JSON has no form for")


def _plain_array(array: np.ndarray[Any, Any]) -> Json:
    if np.iscomplexobj(array):
        return _plain_array(np.stack([array.real, array.imag], axis=-1))
    if array.dtype.kind != "f" or np.isfinite(array).all():
        return array.tolist()
    return plain(array.tolist())


def dumps(document: Record) -> str:
    """The document as text: a line for each column and point, numbers in the shortest form that reads back equal."""
    return _lay_out(document, 0) + "\n"


def branch_text(branch: Record) -> str:
    """A branch's entry of `branches` as it stands in the text of a document."""
    return "    " + _lay_out(branch, 2)


def escaped(text: str) -> str:
    """JSON text in ASCII alone: every other character as its escape, which a reader turns back."""
    return "".join(c if c < "\x7f" else json.dumps(c)[1:-1] for c in text) if not text.isascii() else text


def _lay_out(value: object, depth: int) -> str:
    """Nested mappings and lists of mappings over several lines, anything else (long number lists) on one."""
    inner = "  " * (depth + 1)
    if isinstance(value, Mapping) and value and any(isinstance(entry, Mapping | list) for entry in value.values()):
        lines = [f"{inner}{json.dumps(str(key))}: {_lay_out(entry, depth + 1)}" for key, entry in value.items()]
        return "{\n" + ",\n".join(lines) + "\n" + "  " * depth + "}"
    if isinstance(value, list) and value and isinstance(value[0], Mapping):
        return "[\n" + ",\n".join(inner + _lay_out(entry, depth + 1) for entry in value) + "\n" + "  " * depth + "]"
    return LINE.encode(value)


def write(document: Record, path: Path) -> None:
    """Write the document with its `sha256` so that a reader sees the old file or the whole new one, never a part."""
    write_json_text(dumps(signed(document)), path)


def write_json_text(text: str, path: Path) -> None:
    """`write_text`, with what UTF-8 has no form for (halves of surrogate pairs) as JSON's escapes."""
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        text = escaped(text)
    write_text(path, text)


def read(path: Path) -> Fields:
    """Read a document that `write` wrote; where its `sha256` is absent or wrong, it gets a note, and a warning is made.

    Raises
    ------
    InputError
        The file cannot be read, is not JSON, or is not a contin result.
    FormatVersionError
        It was written in a newer format.
    """
    document = read_mapping(path)
    if not isinstance(document.get("branches"), list):
        raise InputError(f"{path}: not a contin result: expected a mapping with `contin` and `branches`")
    version = document.get("contin")
    if isinstance(version, bool) or not isinstance(version, int) or version > FORMAT_VERSION:
        raise FormatVersionError(
            f"{path}: written in format {version}; this contin reads up to {FORMAT_VERSION}. Install a newer contin."
        )
    wrong = mistake(document)
    document.pop(KEY, None)
    validate(document, path)
    if wrong is not None:
        document["notes"] = [*document["notes"], f"{path.name} {wrong}"]
        warnings.warn(f"{path}: {wrong}", DamageWarning, stacklevel=2)
    return document


def read_mapping(path: Path) -> Fields:
    """A JSON file that holds a mapping; InputError for anything else, also for numbers beyond all bounds."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    except json.JSONDecodeError as error:
        raise InputError(f"{path}:{error.lineno}:{error.colno}: not JSON: {error.msg}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file in UTF-8") from None
    except RecursionError:
        raise InputError(f"{path}: not a contin result: nested too deeply") from None
    except ValueError as error:  # an integer of thousands of digits
        raise InputError(f"{path}: not a contin result: {error}") from None
    if not isinstance(document, dict):
        raise InputError(f"{path}: not a contin result: expected a mapping with `contin` and `branches`")
    return document
