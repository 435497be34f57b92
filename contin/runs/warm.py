"""Loading the numerical part before the first run, so that a branch's `seconds` are its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

# Equilibria p = x^2 with a fold at p = 0 and a Hopf point at p = 1 (the Bogdanov-Takens normal form): one short branch
# that takes the engine through march, location, verification and normal forms.
MODEL: Final[dict[str, Any]] = {
    "name": "warm-up",
    "states": {"x": 1.1, "y": 0},
    "parameters": {"p": 1.21, "q": -1},
    "equations": {"x": "y", "y": "q*y + p - x^2 + x*y"},
}
CURVES: Final = ("LPC", "PD", "NS", "BPC")  # in two parameters, of special orbits


def warm_up(orbits: bool = False, curves: bool = False) -> None:
    """Follow one small branch: imports what runs import, and loads (the first time on a machine, compiles) kernels.

    `orbits` follows a few periodic orbits too; `curves` evaluates the equations of a curve of special orbits at one.
    """
    from contin import api
    from contin.model.yaml_loader import model_from_mapping

    start = api.equilibrium(model_from_mapping(MODEL, check=False))
    branch = api.continuation(start, "p", (-0.5, 1.21), direction="down", settings={"steps": 200})
    hopf = next((point for point in branch.points if point.type == "HB"), None)
    if (orbits or curves) and hopf is not None:
        family = api.continuation(hopf.switch(), "p", (-0.5, 1.21), settings={"steps": 2})
        if curves:
            _load_curves(family.problem, family.z[-1])


def _load_curves(family: Any, orbit: Any) -> None:
    """The kernel of curves of special orbits, which measures any orbit as if it were one."""
    from contin.problems.orbits.loci.curve import OrbitCurve
    from contin.problems.orbits.loci.problem import OrbitLocusProblem

    curve = OrbitCurve("PD", family, 1)
    z = curve.join(orbit, float(family.base[1]))
    curve.settle(z, OrbitLocusProblem(curve).initial_scale(z, (-0.5, 1.21)))


def is_compiled(orbits: bool, curves: bool = False) -> bool:
    """False where the next warm-up compiles: on the first run, and the first with orbits or curves, on a machine."""
    from contin.kernels.compile import kernel_cache_folder, kernels_are_cached

    names = ["collocation_march.*.nbc"] * (orbits or curves) + ["march.follow_special*.nbc"] * curves
    return kernels_are_cached() and all(any(Path(kernel_cache_folder()).rglob(name)) for name in names)
