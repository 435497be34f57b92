"""Equilibria and periodic orbits that runs start from."""

from __future__ import annotations

from typing import Any

from contin.continuation.orbit import orbit_of
from contin.errors import ContinError
from contin.notebook import html


def solution_page(solution: Any) -> str:
    """What it is, in words; of an orbit its picture too, of an equilibrium its states and parameters."""
    inner = getattr(solution, "solution", solution)  # as it was found
    inner = getattr(inner, "equilibrium", inner)
    return html.paragraph(str(solution)) + (_orbit(inner) if hasattr(inner, "period") else _states(inner))


def _states(solution: Any) -> str:
    system = solution.system
    if not system.state_names:  # a function of many states
        return ""
    states = dict(zip(system.state_names, solution.u.tolist(), strict=True))
    parameters = dict(zip(system.parameter_names, solution.p.tolist(), strict=True))
    return html.values(states) + html.details("parameters", html.values(parameters))


def _orbit(solution: Any) -> str:
    """Its picture; nothing where the problem has no parameter, and so no way to sample it."""
    names = getattr(solution, "map", None) or solution.system
    if not names.parameter_names:
        return ""
    try:
        seed = solution.seed(names.parameter_names[0])
        orbit = orbit_of(seed.problem, seed.z, seed.problem.multipliers(seed.z), "this orbit")
        return html.image(orbit.plot(), "periodic orbit")
    except ContinError as error:
        return html.paragraph(f"no picture: {error}")
