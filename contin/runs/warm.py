"""Loading the numerical part before the first run, so that a branch's `seconds` are its own."""

from __future__ import annotations

from typing import Any, Final

# Equilibria p = x^2 with a fold at p = 0 and a Hopf point at p = 1 (the Bogdanov-Takens normal form): one short branch
# that takes the engine through march, location, verification and normal forms.
MODEL: Final[dict[str, Any]] = {
    "name": "warm-up",
    "states": {"x": 1.1, "y": 0},
    "parameters": {"p": 1.21, "q": -1},
    "equations": {"x": "y", "y": "q*y + p - x^2 + x*y"},
}


def warm_up() -> None:
    """Follow one small branch: imports what runs import, and loads (the first time on a machine, compiles) kernels."""
    from contin import api
    from contin.model.yaml_loader import model_from_mapping

    start = api.equilibrium(model_from_mapping(MODEL, check=False))
    api.continuation(start, "p", (-0.5, 1.21), direction="down", settings={"steps": 200})
