"""Which foreign files can be read and written: a reader and a writer for each ending.

A reader takes (text, path) and returns `Imported`; `path` is for messages, for the model's name, and for files that
stand beside it. A writer takes a `Model` and returns `Exported`. Neither executes anything of a file: formulas become
text in contin's grammar, which is parsed like every other. What has no equal here is an `UnsupportedError` that names
it.

A package adds a reader by an entry point of the group `contin.importers` (a writer: `contin.exporters`):

    [project.entry-points."contin.importers"]
    vfgen = "acme_models.vfgen:read"      # ENDING = function
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeAlias, cast

from contin.errors import InputError, InputWarning, ModelNotFoundError
from contin.exchange.imported import Exported, Imported, UnsupportedError
from contin.model.kinds import need_no_events
from contin.model.yaml_loader import model_from_mapping

if TYPE_CHECKING:
    from contin.model.model import Model

READERS: Final = {
    ".xml": "contin.exchange.xml_text:read",
    ".sbml": "contin.exchange.xml_text:read",
    ".ant": "contin.exchange.antimony:read",
    ".antimony": "contin.exchange.antimony:read",
    ".ode": "contin.exchange.xpp.read:read",
    ".cellml": "contin.exchange.cellml.reader:read",
    ".m": "contin.exchange.matcont.read:read",
    ".f90": "contin.exchange.auto.read:read",
}
WRITERS: Final[Mapping[str, str]] = {
    ".ode": "contin.exchange.writing.ode:write",
    ".f90": "contin.exchange.writing.fortran:write",
    ".m": "contin.exchange.writing.matlab:write",
    ".jl": "contin.exchange.writing.julia:write",
    ".xml": "contin.exchange.writing.sbml:write",
    ".sbml": "contin.exchange.writing.sbml:write",
    ".yaml": "contin.exchange.writing.yaml:write",
    ".yml": "contin.exchange.writing.yaml:write",
}
EXTRAS: Final = {
    "libsbml": "sbml",
    "antimony": "antimony",
    "myokit": "cellml",
}  # missing module -> the extra that brings it
IMPORTERS: Final = "contin.importers"
EXPORTERS: Final = "contin.exporters"
LARGEST_FILE: Final = 50_000_000  # bytes
OWN: Final = (".yaml", ".yml", ".json")

Reader: TypeAlias = Callable[[str, Path], Imported]
Writer: TypeAlias = Callable[["Model"], Exported]


@cache
def _offered(group: str) -> Mapping[str, EntryPoint]:
    """Readers or writers of other packages by ending; contin's own win."""
    return {f".{entry.name.lower().removeprefix('.')}": entry for entry in entry_points(group=group)}


def endings() -> tuple[str, ...]:
    """Endings of the files that can be read."""
    return tuple(sorted({*READERS, *_offered(IMPORTERS)}))


def is_foreign(name: str | Path) -> bool:
    """True where a reader answers to the name's ending."""
    ending = Path(name).suffix.lower()
    return ending in READERS or (ending not in ("", *OWN) and ending in _offered(IMPORTERS))


def is_written(name: str | Path) -> bool:
    """True where a writer answers to the name's ending."""
    ending = Path(name).suffix.lower()
    return ending in WRITERS or (ending not in ("", *OWN) and ending in _offered(EXPORTERS))


def read(path: str | Path) -> Imported:
    """A foreign file as a plain model document.

    Raises
    ------
    ModelNotFoundError
        There is no such file.
    UnsupportedError
        It uses what contin has no equal for, or a library that is needed to read it is not installed.
    InputError
        It cannot be understood.
    """
    path = Path(path)
    if not is_foreign(path):
        raise InputError(f"{path}: files that end in {path.suffix or 'nothing'} cannot be read; {_known()}")
    if not path.is_file():
        raise ModelNotFoundError(f"no file {path}")
    if path.stat().st_size > LARGEST_FILE:
        raise InputError(f"{path}: larger than {LARGEST_FILE // 1_000_000} million bytes")
    with _needed(path, "reading"):
        reader = cast(Reader, _function(path, READERS, IMPORTERS))
        return reader(decoded(path.read_bytes()), path)


@contextmanager
def _needed(path: Path, what: str) -> Iterator[None]:
    """A library of an extra that is not installed is told with the extra's name."""
    try:
        yield
    except ModuleNotFoundError as error:
        extra = EXTRAS.get(str(error.name))
        if extra is None:
            raise
        raise UnsupportedError(f"{path}: {what} it needs {error.name}: pip install 'contin[{extra}]'") from None


def load(path: str | Path) -> Model:
    """The model in a foreign file; what its reader notes is a warning each."""
    found = read(path)
    for note in found.notes:
        warnings.warn(f"{path}: {note}", InputWarning, stacklevel=2)
    return model_of(found, path)


def model_of(found: Imported, path: str | Path) -> Model:
    """The model of what was read from `path`."""
    return model_from_mapping(found.model, str(path))


def write(model: Model, path: str | Path) -> Exported:
    """The text of a foreign file of the kind that the ending of `path` names."""
    path = Path(path)
    if not is_written(path):
        raise InputError(f"{path}: models cannot be written to files that end in {path.suffix or 'nothing'}")
    with _needed(path, "writing"):
        if path.suffix.lower() not in (".yaml", ".yml"):
            need_no_events(model, f"files that end in {path.suffix}")
        writer = cast(Writer, _function(path, WRITERS, EXPORTERS))
        return writer(model)


def decoded(data: bytes) -> str:
    """The text of a file: UTF-8 or UTF-16 by its mark, UTF-8 where that reads it, else Latin-1."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", "replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _function(path: Path, own: Mapping[str, str], group: str) -> Callable[..., object]:
    ending = path.suffix.lower()
    if ending in own:
        module, _, name = own[ending].partition(":")
        found: Callable[..., object] = getattr(import_module(module), name)
        return found
    loaded: Callable[..., object] = _offered(group)[ending].load()
    return loaded


def _known() -> str:
    return f"known endings: {', '.join(endings())}"
