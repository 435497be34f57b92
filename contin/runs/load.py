"""Run file -> `RunEntry`, or one error with everything that is wrong with its shape."""

from __future__ import annotations

from pathlib import Path as FilePath
from typing import Final, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from contin.errors import InputError
from contin.model.misshapen import note
from contin.model.schema import shown
from contin.model.shape import check_version, plain
from contin.model.source import Path, Problems, Source
from contin.model.yaml_reader import read_file
from contin.records import Json
from contin.runs.schema import RunEntry

VALUES: Final = (
    "unknown key: values of parameters stand in the start, {x: 1, parameters: {a: 2}}, or, for all runs, under "
    "`parameters:` at the top of the file"
)
BOTH: Final = (
    "unknown key: a curve in two parameters is written `parameter: [a, b]`, with `range: {a: [0, 1], b: [0, 1]}`"
)
_EXAMPLES: Final = {
    "model": "add `model: NAME` (see `contin models`), a path, or a whole model",
    "parameter": "add `parameter: NAME`, the parameter to vary",
}


_Shape = TypeVar("_Shape", bound=BaseModel)


def load_run_file(path: FilePath) -> tuple[RunEntry, Source]:
    """The entries of a run file, and where each of them stands.

    Raises
    ------
    InputError
        Everything that is wrong with the shape of the file, each with `file:line:column: path: what, what to write`.
    FormatVersionError
        The file is written for a newer format.
    """
    document = read_file(path)
    return read_run(document.data, document.source), document.source


def read_run(data: object, source: Source, *, version_required: bool = True) -> RunEntry:
    """The entries of a run file from plain data; `source` finds their places for messages."""
    return read_entries(data, source, RunEntry, version_required=version_required)


def read_entries(data: Json, source: Source, shape: type[_Shape], *, version_required: bool = True) -> _Shape:
    """The entries of a file of this shape from plain data; `source` finds their places for messages."""
    problems = Problems(source)
    if not isinstance(data, dict):
        problems.add((), f"expected a run file (a mapping with model and continuations), got {shown(data)}")
        problems.raise_if_any()
    if "equations" in data and "model" not in data:
        problems.add((), "this is a model file; name it under `model:` in a run file (`contin new NAME` writes one)")
        problems.raise_if_any()
    check_version(data, problems, version_required)
    data = {key: value for key, value in plain(data).items() if value is not None}  # an empty section is no section
    try:
        entry = shape.model_validate(data)
    except ValidationError as error:
        for item in error.errors(include_url=False, include_context=False):
            _note(item, problems, shape)
        problems.raise_if_any()
        raise InputError(str(error)) from None
    problems.raise_if_any()
    return entry


def _note(item: Json, problems: Problems, shape: type[BaseModel]) -> None:
    value = item.get("input")
    count = len(value) if isinstance(value, list) else shown(value)
    own = {"too_long": f"expected one parameter or two, got {count}"}
    if item["loc"][-1:] == ("parameters",):  # empty: of the file as a whole
        own["extra_forbidden"] = BOTH if isinstance(value, list) else VALUES
    note(item, problems, lambda path: _keys_at(path, shape), _EXAMPLES, own)


def _keys_at(path: Path, shape: type[BaseModel]) -> list[str]:
    """Keys that the entry at `path` may have, as they are written in the file."""
    entry: type[BaseModel] = shape
    for part in path:
        if isinstance(part, str):
            field = next((f for name, f in entry.model_fields.items() if (f.alias or name) == part), None)
            inner = None if field is None else _entry_in(field.annotation)
            if inner is None:
                return []
            entry = inner
    return [field.alias or name for name, field in entry.model_fields.items()]


def _entry_in(annotation: object) -> type[BaseModel] | None:
    """The entry type inside `Entry | None` or `list[Entry]`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for argument in get_args(annotation) if (found := _entry_in(argument)) is not None), None)
