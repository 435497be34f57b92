"""Importing the numerical part before the first run, so that a branch's `seconds` are its own.

Kernels are loaded, or compiled, when they are first called: the clock of a branch stands still meanwhile
(`contin.kernels.clock`). What is imported only then, such as parts of scipy, is loaded here.
"""

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

WAITS: Final = {  # by the beginning of a kernel's module: what it is for, how long it takes to compile
    "contin.kernels.special_orbits": ("of curves of periodic orbits ", "about two minutes"),
    "contin.kernels.collocation": ("of periodic orbits ", "about a minute"),
    "contin.kernels.locus": ("of curves in two parameters ", "about half a minute"),
    "contin.kernels.piecewise": ("of trajectories with events ", "about a minute"),
    "contin.kernels.algebraic": ("", "about 15 seconds"),
}


def warm_up() -> None:
    """Follow one small branch."""
    from contin import api
    from contin.model.yaml_loader import model_from_mapping

    start = api.equilibrium(model_from_mapping(MODEL, check=False))
    api.continuation(start, "p", (-0.5, 1.21), direction="down", settings={"steps": 200})


def waiting(module: str) -> str | None:
    """The line that explains the wait while a kernel of this module is compiled; None for those soon done."""
    for beginning, (what, seconds) in WAITS.items():
        if module.startswith(beginning):
            return f"Compiling the numerical kernels {what}for this machine, once; this takes {seconds} ..."
    return None
