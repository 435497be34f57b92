"""Model files, texts and mappings -> `Model`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path as FilePath

from contin import lazy
from contin.model.build import parts_from_mapping
from contin.model.model import Model
from contin.model.source import CallSource, Source
from contin.model.yaml_reader import Document, read_file, read_text
from contin.records import Json, Record


def load_model(path: str | FilePath) -> Model:
    """The model in a YAML file.

    Raises
    ------
    InputError
        Everything that is wrong with it, each with `file:line:column: path: what, and what to write instead`.
    FormatVersionError
        The file is written for a newer format.
    """
    return model_from_document(read_file(path))


def load_model_text(text: str, filename: str = "model", check: bool = True) -> Model:
    """The model in a YAML text; `filename` is for messages, `check` compares symmetries with the equations."""
    return model_from_document(read_text(text, filename), check)


def model_from_mapping(mapping: Record, where: str | Source = "model", *, check: bool = True) -> Model:
    """The model in plain data of the shape of a model file.

    `where` is for messages: a name, or the `Source` of the data, so that they name file, line and column. `check`
    compares the declared symmetries with the equations.
    """
    source = CallSource(where) if isinstance(where, str) else where
    if _is_pde(mapping):
        discretised: Model = _discretised(mapping, source)
        return discretised
    return Model.from_parts(**parts_from_mapping(mapping, source, check=check))


def model_from_document(document: Document, check: bool = True) -> Model:
    """The model in a document that has been read."""
    if _is_pde(document.data):
        discretised: Model = _discretised(document.data, document.source, True)
        return discretised
    parts = parts_from_mapping(document.data, document.source, version_required=True, check=check)
    return Model.from_parts(**parts)


def _is_pde(data: object) -> bool:
    return isinstance(data, Mapping) and data.get("kind") == "pde"


def _discretised(data: Record, source: Source, version_required: bool = False) -> Json:
    """A file of kind: pde, which is made into a large sparse system."""
    return lazy.module("pde").problem_from_mapping(data, source, version_required)
