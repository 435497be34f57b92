"""Does a point from a file fit its equations? Kernels trust the sizes of what they get, and files are not trusted.

Every part is looked at by the names of its fields, which mean the same everywhere: `base` are all parameters of the
system, `active`, `first`, `second` places among them, `sizes`, `winding` one number a state. Then the unknowns.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from typing import Any, Final

import numpy as np

from contin.bvp.boundary_problem import BoundaryProblem
from contin.continuation.branch import SpecialPoint
from contin.continuation.problem import Problem
from contin.errors import InputError
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.model.model import Model
from contin.problems.conditioned.under_conditions import Conditioned
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.maps.cycle import CycleProblem
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.two_parameters import OrbitCurveProblem
from contin.problems.shooting.shot_orbits import ShootingProblem

AGREEMENT: Final = 1e-6  # of the point's columns, computed from its unknowns, with those that are written beside them
WORDS: Final = {
    "type": str, "label": str, "branch": str, "index": int, "residual": float, "error": float, "also": tuple
}  # fmt: skip
MOST: Final = 10_000  # segments, iterates, periods, intervals


def check(point: SpecialPoint) -> None:
    """InputError or ValueError where the parts do not fit together."""
    for name, kind in WORDS.items():
        if not isinstance(getattr(point, name), kind) or isinstance(getattr(point, name), bool):
            raise InputError(f"{name} is no {kind.__name__}")
    for name in ("values", "vectors", "normal_form"):
        if not _named(getattr(point, name), name != "normal_form"):
            raise InputError(f"{name} are no numbers by name")
    if not isinstance(point.eigenvalues, np.ndarray) or point.eigenvalues.dtype.kind not in "fc":
        raise InputError("eigenvalues are no numbers")
    z = point.z
    for name, array in {"z": z, "tangent": point.tangent, "scale": point.scale}.items():
        if not isinstance(array, np.ndarray) or array.ndim != 1 or array.dtype != float:
            raise InputError(f"{name} is no vector")
        if array.size not in (0, z.size) or not np.all(np.isfinite(array)):
            raise InputError(f"{name} has {array.size} finite entries of {z.size}")
    if not isinstance(point.problem, Problem):
        raise InputError("there are no equations")
    _check_parts(point.problem, 0)
    if not _unknowns_fit(point.problem, z):
        raise InputError(f"{z.size} unknowns do not fit the equations")
    _check_columns(point)


def _named(value: object, numbers: bool) -> bool:
    """A mapping of names to numbers (or, of normal forms, to anything plain)."""
    if not isinstance(value, Mapping) or not all(isinstance(name, str) for name in value):
        return False
    return not numbers or all(isinstance(x, int | float | complex | np.ndarray | np.generic) for x in value.values())


def _check_columns(point: SpecialPoint) -> None:
    """The numbers beside the point are those of its unknowns."""
    with np.errstate(all="ignore"):
        columns = point.problem.columns(point.z[np.newaxis])
    for name, column in columns.items():
        stored, found = float(point.values[name]), float(column[0])
        if np.isfinite(stored) and not abs(found - stored) <= AGREEMENT * max(abs(stored), abs(found), AGREEMENT):
            raise InputError(f"{name} is {found:.6g} where {stored:.6g} is written")


def _check_parts(part: object, depth: int) -> None:
    if depth > 8:
        raise InputError("nested too deeply")
    if isinstance(part, Mapping):
        part = tuple(part.values())
    if isinstance(part, list | tuple):
        for item in part:
            _check_parts(item, depth + 1)
    if not is_dataclass(part) or isinstance(part, Model | type):
        return
    system = getattr(part, "system", None)
    for f in fields(part):
        value: Any = getattr(part, f.name)
        if value is None and "None" not in str(f.type):
            raise InputError(f"{f.name} is missing")
        rule = RULES.get(f.name)
        if rule is not None and not rule(value, system):
            raise InputError(f"{f.name} does not fit the equations")
        _check_parts(value, depth + 1)


def _vector(value: Any, size: int) -> bool:
    return isinstance(value, np.ndarray) and value.dtype == float and value.shape == (size,)


def _place(value: Any, system: Any) -> bool:
    return type(value) is int and 0 <= value < (MOST if system is None else int(system.m))


def _place_or_name(value: Any, system: Any) -> bool:
    return isinstance(value, str) or _place(value, system)


def _positive(value: Any, _: Any) -> bool:
    return value is None or (isinstance(value, np.ndarray) and value.dtype == float and bool(np.all(value > 0.0)))


def _places(value: Any, system: Any) -> bool:
    return isinstance(value, tuple) and all(_place(k, system) for k in value)


def _counted(low: int, high: int) -> Callable[[Any, Any], bool]:
    return lambda value, _: value is None or (type(value) is int and low <= value <= high)


def _of_states(value: Any, system: Any) -> bool:
    return value is None or (isinstance(value, np.ndarray) and (system is None or value.size in (0, int(system.n))))


def _of_parameters(value: Any, system: Any) -> bool:
    return not isinstance(value, np.ndarray) or system is None or _vector(value, int(system.m))


RULES: Final[Mapping[str, Callable[[Any, Any], bool]]] = {
    "base": _of_parameters, "active": _place, "first": _place, "second": _place_or_name,
    "more": _places, "places": _places,
    "winding": _of_states, "sizes": _of_states, "state_periods": _of_states, "angle_periods": _of_states,
    "units": _positive, "points": _counted(1, 7), "intervals": _counted(1, MOST), "multiple": _counted(1, MOST),
    "count": _counted(1, MOST), "times": _counted(1, MOST), "budget": _counted(1, 10**9),
}  # fmt: skip


def _unknowns_fit(problem: Any, z: Any) -> bool:
    """Whether z has as many entries as the problem has unknowns, on some mesh."""
    if isinstance(problem, CycleProblem):
        return bool(z.size == problem.n * problem.period + 1)
    if isinstance(problem, Conditioned):
        return _unknowns_fit(problem.inner, np.append(z[: -1 - len(problem.free)], z[-1:]))
    if isinstance(problem, EquilibriumProblem):
        return bool(z.size == problem.n + 1)
    if isinstance(problem, LocusProblem):
        return bool(z.size == problem.curve.size)
    if isinstance(problem, OrbitProblem | BoundaryProblem):
        return _on_mesh(z, problem.n, problem.points)
    if isinstance(problem, ShootingProblem):
        return bool(z.size == problem.count * problem.n + problem.n + 3)
    if isinstance(problem, OrbitCurveProblem):
        orbits = getattr(problem.curve, "orbits", None)
        if isinstance(orbits, OrbitProblem) and hasattr(problem.curve, "orbit"):
            return _unknowns_fit(orbits, problem.curve.orbit(z))
    return bool(z.size > 1)


def _on_mesh(z: Any, n: int, points: int) -> bool:
    count, rest = divmod(z.size - n - 2, points * n + 1)
    lengths = z[(count * points + 1) * n + 1 : -1]
    return count >= 1 and rest == 0 and bool(np.all(lengths > 0.0) and abs(lengths.sum() - 1.0) < 1e-6)
