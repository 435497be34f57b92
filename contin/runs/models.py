"""From what stands under `model:` to a `Model`: a bundled or plugin name, a path, or a whole model as a mapping."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from contin.model.model import Model
    from contin.model.source import Source

MODEL_ENDINGS: Final = (".yaml", ".yml", ".json")


def resolve_model(reference: str | Mapping[str, Any], folder: Path, source: Source | str = "model") -> Model:
    """The model that `reference` means; relative paths start at `folder`, `source` finds places in a mapping.

    Raises
    ------
    InputError
        There is no such model, or it has mistakes.
    """
    if not isinstance(reference, str):
        from contin.model.yaml_loader import model_from_mapping

        return model_from_mapping(reference, source)
    path = folder / reference
    if reference.lower().endswith(MODEL_ENDINGS) or path.is_file():
        from contin.model.yaml_loader import load_model

        return load_model(path)
    from contin.model.registry import find

    return find(reference)
