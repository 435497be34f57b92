"""A folder of models: YAML files, and Python files with a function `model()`; folders in it are families."""

from __future__ import annotations

import importlib.util
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from contin.errors import InputError
from contin.model.any_model import AnyModel
from contin.model.yaml_loader import load_model
from contin.model.yaml_reader import read_file

if TYPE_CHECKING:
    from types import ModuleType

_SUFFIXES = (".yaml", ".yml", ".py")


@dataclass(frozen=True)
class Family:
    """Models in `folder`; Python files are imported as modules below `package`, one name wherever the folder is."""

    folder: Path
    package: str

    def files(self) -> Mapping[str, Path]:
        """Name (brusselator, or classics/brusselator one folder down) -> file, sorted by name."""
        found: dict[str, Path] = {}
        for path in sorted([*self.folder.glob("*"), *self.folder.glob("*/*")]):
            relative = path.relative_to(self.folder)
            hidden = any(part.startswith(("_", ".")) for part in relative.parts)
            if path.suffix in _SUFFIXES and path.is_file() and not hidden:
                found.setdefault(relative.with_suffix("").as_posix(), path)
        return dict(sorted(found.items()))

    def title(self, name: str) -> str:
        """What the model calls itself; for a Python file, the first line of its text in quotes."""
        path = self.files()[name]
        if path.suffix == ".py":
            match = re.match(r'\s*"""(.*?)(\n|""")', path.read_text(encoding="utf-8"))
            return match.group(1).strip() if match else ""
        try:
            data = read_file(path).data
        except InputError:
            return "(the file cannot be read)"
        return str(data.get("title") or "") if isinstance(data, dict) else ""

    def load(self, name: str) -> AnyModel:
        """The model called `name`, a key of `files()`."""
        path = self.files()[name]
        if path.suffix != ".py":
            return load_model(path)
        module = self._module(name, path)
        make = getattr(module, "model", None)
        if not callable(make):
            raise InputError(f"{path}: has no function model() that returns the model")
        made = make()
        if not isinstance(made, AnyModel):
            raise InputError(f"{path}: model() returned {type(made).__name__}, not a Model or a FunctionProblem")
        return made

    def _module(self, name: str, path: Path) -> ModuleType:
        full = f"{self.package}.{name.replace('/', '.').replace('-', '_')}"
        known = sys.modules.get(full)
        if known is not None and getattr(known, "__file__", None) == str(path):
            return known
        spec = importlib.util.spec_from_file_location(full, path)
        if spec is None or spec.loader is None:
            raise InputError(f"{path}: cannot be imported")
        module = importlib.util.module_from_spec(spec)
        sys.modules[full] = module
        try:
            spec.loader.exec_module(module)
        except BaseException:
            del sys.modules[full]
            raise
        return module
