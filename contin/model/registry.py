"""Models by name: bundled ones and those of other packages, through one mechanism.

A package offers models by an entry point of the group `contin.models`:

    [project.entry-points."contin.models"]
    acme = "acme_models:folder"      # NAME = what it loads to

It may load to a `Model` or a `FunctionProblem`, a folder of model files (a path, or a module whose folder is meant), or
a function that returns one of these. Models of a folder are called NAME/FILE. Nothing of a package is imported until
one of its names is asked for. A package that fails is a warning; the environment variable CONTIN_PLUGINS=0 leaves other
packages out.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import Any, Final

from contin import lazy
from contin.errors import InputError, ModelNotFoundError
from contin.model.advice import closest
from contin.model.any_model import AnyModel
from contin.model.family import Family
from contin.model.yaml_loader import load_model, model_from_mapping
from contin.records import Json, Record

GROUP: Final = "contin.models"
SWITCH: Final = "CONTIN_PLUGINS"
_BUNDLED: Final = EntryPoint("contin", "contin.model.bundled:folder", GROUP)


@dataclass(frozen=True)
class Provider:
    """One entry point and the distribution it belongs to."""

    name: str
    distribution: str
    entry: EntryPoint

    @property
    def bundled(self) -> bool:
        """True for contin's own models, whose names need no prefix."""
        return self.entry.value == _BUNDLED.value

    def load(self) -> AnyModel | Family:
        """What the entry point stands for; raises whatever the package raises."""
        target: object = self.entry.load()
        if callable(target) and not isinstance(target, AnyModel):
            target = target()
        if isinstance(target, AnyModel):
            return target
        if isinstance(target, ModuleType):
            target = Path(str(target.__file__)).parent
        if not isinstance(target, (str, os.PathLike)):
            raise InputError(f"it loads to {type(target).__name__}, not to a Model or a folder of model files")
        path = Path(target)
        if path.is_file():
            return load_model(path)
        if not path.is_dir():
            raise InputError(f"the folder {path} does not exist")
        return Family(path, "contin._models" if self.bundled else f"contin._plugins.{self.distribution}.{self.name}")

    def load_or_warn(self) -> AnyModel | Family | None:
        """The same, but a failure of somebody else's package is a warning that names it."""
        try:
            return self.load()
        except Exception as error:  # somebody else's code may raise anything
            if self.bundled:
                raise
            warnings.warn(
                f"models {self.name!r} of the package {self.distribution} cannot be loaded: "
                f"{type(error).__name__}: {error}",
                stacklevel=3,
            )
            return None


@dataclass(frozen=True)
class Listed:
    """A line of the list of models; a package that was not imported is one line without a title."""

    name: str
    source: str
    family: Family | None = None  # whose file has the title; read when it is asked for

    @property
    def title(self) -> str:
        return "" if self.family is None else self.family.title(self.name)

    def __iter__(self) -> Iterator[str]:
        return iter((self.name, self.title, self.source))


def providers() -> list[Provider]:
    """Bundled models first, then other packages by name; none of them is imported."""
    found: dict[tuple[str, str], Provider] = {}
    for entry in (_BUNDLED, *entry_points(group=GROUP)):
        distribution = entry.dist.name if entry.dist is not None else "contin"
        found.setdefault((entry.name, entry.value), Provider(entry.name, distribution, entry))
    everything = sorted(found.values(), key=lambda p: (not p.bundled, p.name, p.distribution))
    if os.environ.get(SWITCH, "1").strip().lower() in ("0", "off", "false", "no"):
        return [p for p in everything if p.bundled]
    return everything


def listing() -> list[Listed]:
    """Name, title and providing distribution of every model, without importing other packages."""
    lines: list[Listed] = []
    for provider in providers():
        family = provider.load() if provider.bundled else None
        if isinstance(family, Family):
            lines += [Listed(name, provider.distribution, family) for name in family.files()]
        elif not provider.bundled:
            lines.append(Listed(provider.name, provider.distribution))
    return lines


def load(model: str | os.PathLike[str] | Record) -> Json:
    """A model by its name, by the path of a model file, or from a mapping of the shape of one.

    A `Model`; a `FunctionProblem` where a package gives one.

    >>> contin.load("metronomes/pair")
    >>> contin.load("models/duffing.yaml")
    """
    if isinstance(model, Mapping):
        return model_from_mapping(model)
    return find(model)


def find(name: str | os.PathLike[str], base_folder: str | os.PathLike[str] = ".") -> Any:
    """The model called `name`: a path (relative to `base_folder`) if it ends in .yaml, .yml, .json
    or the ending of a foreign format (.ode, .sbml, ...) or names a file,
    otherwise the name of a bundled or plugin model, whose family may be left out where that is unambiguous.

    Raises
    ------
    ModelNotFoundError
        Nothing has this name; the text names close ones.
    InputError
        Two packages offer the name, or the file is wrong.
    """
    text = os.fspath(name)
    path = Path(base_folder) / Path(text).expanduser()
    foreign = bool(path.suffix) and lazy.module("exchange").is_foreign(path)
    written_as_path = not isinstance(name, str) or foreign or text.lower().endswith((".yaml", ".yml", ".json"))
    if written_as_path or text.startswith(("./", "../", "~", "/")) or "\\" in text:
        if not path.exists():
            raise ModelNotFoundError(f"no model file {path}{_nearby(path)}")
        return lazy.module("exchange").load(path) if foreign else load_model(path)
    offers = _offers(text)
    if len(offers) == 1:
        return offers[0].load()
    if offers:
        raise InputError(f"several models are called {text!r}: {' and '.join(o.described for o in offers)}")
    if path.is_file():
        return load_model(path)
    raise ModelNotFoundError(_not_found(text))


@dataclass(frozen=True)
class _Offer:
    """A model that answers to the name asked for."""

    provider: Provider
    name: str
    found: AnyModel | Family

    def load(self) -> AnyModel:
        return self.found.load(self.name) if isinstance(self.found, Family) else self.found

    @property
    def described(self) -> str:
        full = self.name if self.provider.bundled else self.provider.name
        if not self.provider.bundled and isinstance(self.found, Family):
            full = f"{full}/{self.name}"
        return f"{self.provider.distribution}:{full}"


def _offers(text: str) -> list[_Offer]:
    """Models that answer to a name: those called exactly so, and bundled ones called so within their family."""
    package, colon, wanted = text.rpartition(":")
    offers: list[_Offer] = []
    for provider in providers():
        if colon and provider.distribution != package:
            continue
        if provider.bundled:
            family = provider.load()
            if isinstance(family, Family):
                names = list(family.files())
                exact = [n for n in names if n == wanted]
                short = [n for n in names if n.rpartition("/")[2] == wanted]
                offers += [_Offer(provider, n, family) for n in exact or short]
        elif wanted == provider.name or wanted.startswith(f"{provider.name}/"):
            found = provider.load_or_warn()
            inner = wanted[len(provider.name) + 1 :]
            if (isinstance(found, AnyModel) and not inner) or (isinstance(found, Family) and inner in found.files()):
                offers.append(_Offer(provider, inner, found))
    return offers


def _not_found(text: str) -> str:
    names = [line.name for line in listing()]
    shorts = {name.rpartition("/")[2]: name for name in names}
    family = [n for n in names if n.startswith(f"{text}/")]
    if family:
        advice = f"it is a family; its models are {', '.join(family)}."
    else:
        advice = closest(text, names) or closest(text.rpartition("/")[2], shorts) or "`contin models` lists all."
    return f"no model is called {text!r}: {advice} For a file give its path, such as ./{Path(text).name}.yaml"


def _nearby(path: Path) -> str:
    if not path.parent.is_dir():
        return f": there is no folder {path.parent}"
    files = [p.name for p in path.parent.iterdir() if p.suffix in (".yaml", ".yml", ".json", path.suffix)]
    advice = closest(path.name, files)
    return f": {advice}" if advice else ""
