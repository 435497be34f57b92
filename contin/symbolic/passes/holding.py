"""Does a model that a pass has made keep a symmetry? Sampled, as for the symmetries that a model file declares."""

from __future__ import annotations

import warnings

from contin.model.model import Model
from contin.model.parts import Symmetry
from contin.model.source import CallSource, Problems
from contin.model.symmetry import check_symmetries
from contin.records import Fields


def holds(model: Model, symmetry: Symmetry) -> bool:
    """True where the equations have the symmetry; False also where they are finite at no sampled point."""
    problems = Problems(CallSource("pass"))
    parts: Fields = {
        "states": model.states,
        "parameters": model.parameters,
        "equations": model.equations,
        "kind": model.kind,
        "symmetries": [symmetry],
    }
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            check_symmetries(parts, problems)
        except UserWarning:
            return False
    return not problems
