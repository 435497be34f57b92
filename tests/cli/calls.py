"""Calling the command inside the test's process, and the run files that tests share."""

import json
from pathlib import Path
from typing import Any

import pytest

from contin.cli.main import main

FOLD = {  # x' = p - x^2: a fold at p = 0
    "contin": 1,
    "name": "fold",
    "states": {"x": 1.0},
    "parameters": {"p": {"value": 1, "range": [-1, 2]}, "q": 1},
    "equations": {"x": "p - q*x^2"},
    "starts": {"low": {"x": -1}, "half": {"x": 0.5, "parameters": {"p": 0.25}}},
}
PITCHFORK = {  # x' = p x - x^3
    "contin": 1,
    "name": "pitchfork",
    "states": {"x": 0.0},
    "parameters": {"p": -1},
    "equations": {"x": "p*x - x^3"},
    "symmetries": {"flip": {"x": "-x"}},
}


def call(*arguments: str) -> int:
    """Exit code of `contin ARGUMENTS`."""
    with pytest.raises(SystemExit) as stopped:
        main([str(argument) for argument in arguments])
    code = stopped.value.code
    return code if isinstance(code, int) else 0 if code is None else 1


def run_file(folder: Path, model: Any, *continuations: Any, name: str = "case.yaml", **more: Any) -> Path:
    """Write a run file (JSON is YAML); its path."""
    path = folder / name
    document = {"contin": 1, "model": model, **more}
    if continuations:
        document["continuations"] = list(continuations)
    path.write_text(json.dumps(document, indent=1))
    return path


def results(path: Path) -> Any:
    """The JSON results in a file."""
    return json.loads(path.read_text())
