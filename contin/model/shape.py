"""Plain data -> `ModelEntry`: every mistake of shape is noted at its place and mended, so that checking goes on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from pydantic import BaseModel, ValidationError

from contin.errors import FormatVersionError, InputError
from contin.model import features, schema
from contin.model.expression import Expression
from contin.model.misshapen import note, place_of
from contin.model.schema import FORMAT_VERSION, ModelEntry, shown
from contin.model.source import Path, Problems
from contin.records import Fields, Json

MAX_DEPTH: Final = 40
_NAMED_FORMULAS: Final = frozenset({"states", "parameters", "equations", "definitions", "functions", "observables"})
_EXAMPLES: Final = {
    "name": "add `name: my-model`",
    "states": "add `states: {x: 0}`",
    "equations": "add `equations: {x: ...}`",
    "value": "add `value: 0`",
    "position": "name the state that is the position",
    "velocity": "name the state that is the velocity",
    "small": "name the small parameter",
    "oscillators": "add `oscillators: [{position: x, velocity: y}]`",
    "period": "add `period: 2*pi`",
    "label": "add `label: HB`, say",
    "at": "add `at: {parameter: value}`, or `at: []` where none is expected",
}


def plain(value: Json, depth: int = 0) -> Json:
    """Mappings, sequences and numpy scalars as dict, list, int and float; everything else as it is."""
    if depth > MAX_DEPTH:
        raise InputError(f"a model nested deeper than {MAX_DEPTH} levels")
    if isinstance(value, (bool, str, int, float, Expression)) or value is None:
        return float(value) if isinstance(value, float) else value
    if isinstance(value, Mapping):
        return {str(k): plain(v, depth + 1) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v, depth + 1) for v in value]
    item = getattr(value, "item", None)  # numpy scalars and 0-d arrays
    if callable(item) and getattr(value, "ndim", None) == 0:
        return plain(item(), depth + 1)
    numerator = getattr(value, "numerator", None)
    if isinstance(numerator, int):
        return f"{numerator}/{value.denominator}"
    return value


def check_version(data: object, problems: Problems, required: bool) -> None:
    """Refuse files of a newer format before anything else is read."""
    if not isinstance(data, Mapping):
        return
    if "contin" not in data:
        if required:
            problems.add((), f"the format version is missing; add `contin: {FORMAT_VERSION}` as the first line")
        return
    version = data["contin"]
    if isinstance(version, int) and not isinstance(version, bool) and version > FORMAT_VERSION:
        _, heading, snippet = problems.source.locate(("contin",), False, None, None)
        message = (
            f"{heading}: contin: format version {version} is newer than this program reads "
            f"({FORMAT_VERSION}); upgrade contin, or write `contin: {FORMAT_VERSION}`"
        )
        raise FormatVersionError(message + (f"\n{snippet}" if snippet else ""))


def validate(data: Json, problems: Problems) -> ModelEntry:
    """The typed entries; raises if what is left after mending cannot be used."""
    if not isinstance(data, dict):
        problems.add((), f"expected a model (a mapping with name, states, equations), got {shown(data)}")
        problems.raise_if_any()
    for section, value in list(data.items()):
        if value is None and section in ModelEntry.model_fields:
            del data[section]  # an empty section is no section
    for _ in range(2):
        try:
            return ModelEntry.model_validate(data)
        except ValidationError as error:
            for item in error.errors(include_url=False, include_context=False):
                _note(item, problems)
            for item in error.errors(include_url=False, include_context=False):
                _mend(data, place_of(item), item["type"])
    problems.raise_if_any()
    raise InputError("the model cannot be read")


def _note(item: Json, problems: Problems) -> None:
    path, kind, value = place_of(item), item["type"], item.get("input")
    own = {}
    if kind == "extra_forbidden" and len(path) == 1 and features.of_key(str(path[0])):
        problems.add(path, f"unknown key: {features.of_key(str(path[0]))}", key=True)
        return
    if kind == "literal_error":
        expected = str(item["msg"]).removeprefix("Input should be ").replace("'", "")
        feature = ""
        if path == ("kind",):
            expected, feature = expected.replace(" or ", ", ") + " or pde", features.of_kind(value)
        own[kind] = f"expected {expected}, got {shown(value)}" + (f"; {feature}" if feature else "")
    note(item, problems, lambda _: _allowed_keys(path), _EXAMPLES, own)


def _allowed_keys(real: Path) -> list[str]:
    entries: dict[tuple[int, str], type[BaseModel]] = {
        (1, ""): schema.ModelEntry,
        (3, "states"): schema.StateEntry,
        (3, "parameters"): schema.ParameterEntry,
        (2, "averaging"): schema.AveragingEntry,
        (4, "averaging"): schema.OscillatorEntry,
        (2, "forcing"): schema.ForcingEntry,
        (3, "expect"): schema.ExpectEntry,
    }
    section = "" if len(real) == 1 else str(real[0])
    entry = entries.get((len(real), section))
    if real[:2] == ("averaging", "rotators"):
        entry = schema.RotatorEntry
    return list(entry.model_fields) if entry is not None else []


def _mend(data: Fields, path: Path, kind: str) -> None:
    """Take a wrong value out, or put a harmless one in its place, so that the rest can be checked."""
    if not path or (kind == "missing" and len(path) == 1):
        return
    if kind == "extra_forbidden" and _delete(data, path):
        return
    section = path[0]
    if len(path) >= 2 and section in _NAMED_FORMULAS and isinstance(data.get(str(section)), dict):
        data[str(section)][path[1]] = 1
    elif section not in ("name", "states", "equations"):
        data.pop(str(section), None)


def _delete(data: Json, path: Path) -> bool:
    for part in path[:-1]:
        try:
            data = data[part]
        except (KeyError, IndexError, TypeError):
            return False
    if isinstance(data, dict) and path[-1] in data:
        del data[path[-1]]
        return True
    return False
