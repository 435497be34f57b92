"""Connecting orbits, where curves and branches of them may start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.api.starts import equilibrium
from contin.continuation.branch import SpecialPoint
from contin.errors import ExpressionError, InputError
from contin.homoclinic.cycle_connections import CycleConnection
from contin.homoclinic.from_saddles import ConnectingOrbit
from contin.homoclinic.from_table import Path
from contin.homoclinic.reversor import reversor_of
from contin.homoclinic.saddle_connections import ConnectionProblem
from contin.homoclinic.several_pulses import Pulses
from contin.lowering.system import CompiledSystem
from contin.model.expression import Expression
from contin.model.kinds import need_time
from contin.model.model import Model
from contin.model.parser import parse
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.corotating import system_of_orbits
from contin.problems.orbits.rests_and_cycles import Cycle, Rest
from contin.records import Record
from contin.search.equilibrium_from_guess import Equilibrium

LARGEST_TRUNCATION: Final = 0.1
MOST_PULSES: Final = 5


def connection(
    origin: Model | SpecialPoint,
    first: str | Record | SpecialPoint | None = None,
    last: str | Record | SpecialPoint | None = None,
    parameters: Record | None = None,
    *,
    samples: tuple[Array, Array] | None = None,
    truncation: float | None = None,
    reversor: Mapping[str, str | float] | None = None,
    pulses: int | None = None,
) -> ConnectingOrbit | CycleConnection | Pulses:
    """The start of a curve, in two parameters, of orbits that lead from one saddle to another.

    origin : a model; or a point of a family of periodic orbits, whose long orbit passes the saddle.
    first, last : named starts or mappings of states, from which the saddles are solved; without `last` the orbits
        return to the first one (homoclinic). Either may be a labelled point of a family of periodic orbits instead: a
        cycle, at that point's parameters, that the orbit leaves or comes to.
    samples : (times (K,), states (K, n)) along the orbit. Without them (and a periodic orbit) trajectories in the
        unstable manifold of the first saddle are tried: one that misses the second saddle is brought to it by a
        homotopy in the first parameter.
    truncation : distance of the orbit's ends from the saddles, relative to its extent (default 1e-5, where rounding and
        mesh allow it); the error is of the order of its square.
    reversor : images of states under a reflection R with f(R u) = -R f(u), formulas such as {"v": "-v"}. The orbits are
        then those that R maps onto themselves; of them half is solved for. They persist in one parameter where the
        unstable manifold and the fixed space of R have dimensions with sum n, and need two where it is n - 1.
    pulses : from a labelled point of a curve of homoclinic orbits (`origin`): orbits that make so many turns before
        they return, by Lin's method.

    `continuation(..., (p, q), ranges)` solves for the orbit at the present value of q. Where the dimensions of the two
    manifolds add up to n + 1, the connection persists, and `continuation(..., p, range)` follows it in one parameter.

    Raises InputError or NoSolutionError, in `continuation`, with the step that failed.
    """
    if truncation is not None and not 1e-8 <= truncation <= LARGEST_TRUNCATION:
        raise InputError(
            f"truncation: a relative distance from 1e-8 to {LARGEST_TRUNCATION:g} of the ends from the saddles; got "
            f"{truncation:g}"
        )
    if reversor is not None and last is not None:
        raise InputError("a connecting orbit that a reversor maps onto itself leads to the image of `start`: no `to`")
    if pulses is not None:
        return _of_pulses(origin, pulses)
    path = None if samples is None else Path(np.asarray(samples[0], float), np.asarray(samples[1], float))
    if isinstance(first, SpecialPoint) or isinstance(last, SpecialPoint):
        if reversor is not None or isinstance(origin, SpecialPoint):
            raise InputError(f"a connecting orbit to a cycle: leave out `{'from' if reversor is None else 'reversor'}`")
        found = _with_cycles(first, last, parameters)
        return replace(found, path=path, truncation=truncation or found.truncation)
    if isinstance(origin, SpecialPoint) and reversor is not None:
        raise InputError("a symmetric connecting orbit starts from a model and `samples`, not from a periodic orbit")
    if isinstance(origin, SpecialPoint):
        return _of_orbit(origin, first, last, samples, truncation)
    need_time(origin, "connecting orbits")
    saddles = _saddles(origin, first, last, parameters)
    system = system_of_orbits(saddles[0].system)
    if not isinstance(system, CompiledSystem):
        raise InputError("connecting orbits need a flow given by formulas")
    symmetric = None if reversor is None else reversor_of(system, saddles[0].p, _images(origin, reversor))
    states = np.array([saddle.u for saddle in saddles])
    return ConnectingOrbit(system, saddles[0].p, states, path, truncation, symmetric)


def _images(model: Model, reversor: Mapping[str, str | float]) -> dict[str, Expression]:
    """Formulas in states and parameters."""
    images, names = {}, [*model.state_names, *model.parameter_names]
    for name, formula in reversor.items():
        if name not in model.state_names:
            raise InputError(f"reversor: {name!r} is no state; states are {', '.join(model.state_names)}")
        try:
            images[name] = parse(str(formula), names, model.functions)
        except ExpressionError as error:
            raise InputError(f"reversor: {name}: {error}") from None
    return images


connecting_orbit = connection


def _of_pulses(point: Model | SpecialPoint, count: int) -> Pulses:
    """Orbits of several turns near that of a labelled point."""
    if not isinstance(point, SpecialPoint) or not isinstance(point.problem, ConnectionProblem):
        raise InputError("pulses: orbits of several turns start from a label of a curve of homoclinic orbits, `from`")
    where, curve = f"{point.branch}.{point.label}", point.problem.curve
    plain = curve.saddles == 1 and not curve.node and curve.reversor is None and curve.winding is None
    if not plain or point.problem.isolated:
        raise InputError(
            f"{where} is no homoclinic orbit to a saddle in two parameters: it has no orbits of more turns"
        )
    if not 2 <= count <= MOST_PULSES:
        raise InputError(f"pulses: from 2 to {MOST_PULSES} turns; got {count}")
    return Pulses(point.problem, point.z, count, where)


def _with_cycles(
    first: str | Record | SpecialPoint | None, last: str | Record | SpecialPoint | None, parameters: Any
) -> CycleConnection:
    """Ends that are cycles are at their own parameters, which must be the same."""
    points = [end for end in (first, last) if isinstance(end, SpecialPoint)]
    cycles = []
    for point in points:
        where = f"{point.branch}.{point.label}"
        problem = point.problem
        if not isinstance(problem, OrbitProblem):
            raise InputError(f"{where} is no periodic orbit by collocation: connecting orbits leave or come to such")
        cycles.append(Cycle(problem.system, problem.full_parameters(point.z), problem.profile(point.z)))
    system, p = cycles[0].system, cycles[0].p
    if any(not np.allclose(cycle.p, p, rtol=1e-9, atol=1e-12) for cycle in cycles[1:]):
        raise InputError("both cycles of a connecting orbit must be at the same parameters")
    if system.n_switches or system.model.forcing is not None:
        raise InputError("connecting orbits to cycles need a smooth autonomous flow")
    if len(points) == 2 or last is None:
        return CycleConnection(system, p, cycles[0], cycles[-1])
    values = dict(zip(system.parameter_names, (float(x) for x in p), strict=False))
    at_rest = first if isinstance(last, SpecialPoint) else last
    found = equilibrium(system.model, at_rest, {**(parameters or {}), **values})  # type: ignore[arg-type]
    if not isinstance(found, Equilibrium):
        raise InputError("connecting orbits need a flow given by formulas")
    rest = Rest(system, p, np.asarray(found.u))
    return CycleConnection(system, p, *((rest, cycles[0]) if isinstance(last, SpecialPoint) else (cycles[0], rest)))


def _saddles(
    model: Model, first: str | Record | None, last: str | Record | None, parameters: Record | None
) -> list[Equilibrium]:
    ends = [equilibrium(model, one, parameters) for one in (first, first if last is None else last)]
    found = [saddle for saddle in ends if isinstance(saddle, Equilibrium)]
    if not isinstance(model, Model) or len(found) < 2 or found[0].system.kind == "map":
        raise InputError("connecting orbits need a flow given by formulas")
    return found


def _of_orbit(
    point: SpecialPoint, first: str | Record | None, last: str | Record | None, samples: Any, truncation: float | None
) -> ConnectingOrbit:
    """Along a long periodic orbit, from its saddle back to it (from the first one to the second one)."""
    where = f"{point.branch}.{point.label}"
    problem = point.problem
    if samples is not None:
        raise InputError(f"{where}: give a periodic orbit, or samples, not both")
    if not isinstance(problem, OrbitProblem):
        raise InputError(f"{where} is no periodic orbit by collocation: a connecting orbit starts from a long one")
    model = problem.system.model
    if first is None:
        raise InputError(f"{where}: name the saddle that the orbit passes (`start`)")
    p = problem.full_parameters(point.z)
    values = dict(zip(problem.system.parameter_names, (float(x) for x in p), strict=False))
    found = _saddles(model, first, last, values)
    profile = problem.profile(point.z)
    path = Path(profile.times * profile.period, profile.u)
    return ConnectingOrbit(problem.system, p, np.array([saddle.u for saddle in found]), path, truncation)
