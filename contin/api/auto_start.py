"""`start: auto`: a solution from which branches may start, however far the given state is from one.

In this order: the given state where it is at rest; where its trajectory comes to rest, or to a cycle; Newton from where
the trajectory is in the end, and from its mean; deflated Newton from starts all over the box. Which of these found the
solution is said.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any, Final, NamedTuple

import numpy as np

from contin.abi import Array
from contin.api.fixed_totals import for_branches, named_start
from contin.api.found_start import FoundStart
from contin.api.machine_code import compiled
from contin.api.requirements import need_parameters
from contin.api.searches import find_equilibria
from contin.api.zeros_held import with_zeros_held
from contin.errors import AtRestError, ContinError, NoSolutionError, NotFiniteError
from contin.lazy import module
from contin.model.kinds import need_model, need_time
from contin.problems.orbits.periodic_orbit import PeriodicOrbit
from contin.problems.sparse.as_dense import MOST, SMALL
from contin.problems.sparse.from_model import sparse_function
from contin.records import Record
from contin.search.equilibrium_from_guess import Equilibrium, converge
from contin.search.large_equilibrium import LargeEquilibrium, converge_large
from contin.search.orbit_from_samples import orbit_from_samples
from contin.search.relaxed_large import relax_large, sizes
from contin.search.shot_orbit import ShotOrbit, settled_orbit
from contin.simulate.natural import natural_metric
from contin.simulate.relax import Relaxed, relax, stiff_loop
from contin.symbolic.passes.translations import translation_notes
from contin.systems.functions.function_problem import FunctionProblem
from contin.systems.functions.function_system import FunctionSystem
from contin.systems.iterate import iterate

AT_REST: Final = 1e-3  # part of a state's size that Newton may move a state that is given as a rest
SINGULAR: Final = 1e-11  # ratio of singular values of an equilibrium that is one of a line
BUDGET: Final = 200_000  # steps between two looks at whether a trajectory closes
LONGEST: Final = 2e4  # time scales
ITERATES: Final = 4_096
LONGEST_CYCLE: Final = 32  # of a map
REPEATS: Final = 1e-6  # relative difference of an iterate and itself a cycle later
SAME_POINT: Final = 1e-7  # ... of a point of a solved cycle and itself a part of the cycle later, if it repeats
Solution = Equilibrium | LargeEquilibrium | PeriodicOrbit | ShotOrbit
_FAILURES: Final = (NoSolutionError, NotFiniteError, np.linalg.LinAlgError)


def find_start(
    model: Any, parameters: Record | None = None, start: Any = None, *, cycles: bool = True, deflate: bool = True
) -> FoundStart:
    """A solution near which the model lives, found as the head of this file says.

    start : the given state, a named start or a mapping.  cycles : periodic orbits are welcome, not only equilibria.
    deflate : search the box where all else fails.

    Raises NoSolutionError, which names what was tried.
    """
    need_model(model)
    need_time(model, "equilibria or cycles")
    start = named_start(model, start)
    first: FoundStart | NoSolutionError
    try:
        first = _found(for_branches(model), parameters, start, cycles, deflate)
    except NoSolutionError as error:
        first = error
    held = with_zeros_held(model, parameters) if isinstance(first, Exception) or is_singular(first) else None
    if held is None:
        if isinstance(first, Exception):
            raise first
        return first
    reduced, zeros = held
    left = {n: v for n, v in (parameters or {}).items() if n not in zeros}
    found = _found(reduced, left, start, cycles, deflate)
    laws = ", ".join(t.name for t in reduced.totals)
    return replace(found, words=f"{found.words}; with {', '.join(zeros)} held at 0, which conserves {laws}")


def _found(model: Any, parameters: Record | None, start: Any, cycles: bool, deflate: bool) -> FoundStart:
    need_parameters(model)
    u, p = model.start_point(start, dict(parameters or {}))
    system, periods = compiled(model), np.asarray(model.periods(), dtype=float)
    if getattr(model, "forcing", None) is not None:
        found = module("responses").response(system, u, p, periods)
        return FoundStart(found, "cycle", "the response that the trajectory of the given state settles on")
    tried: list[str] = []
    large = _as_large(model, u, p)
    if system.kind == "map":
        ways = _of_map(system, u, p, periods, tried)
    else:
        flow = _small(system, u, p, periods) if large is None else _large(large, u, p)
        cycle = partial(_cycle, system, p, periods, tried) if cycles and (large is None or system.n <= MOST) else None
        ways = _of_flow(flow, u, cycle, tried)
    for one in ways:
        return one
    if deflate and large is None:
        found = _by_deflation(model, parameters, tried)
        if found is not None:
            return found
    tried += translation_notes(model)
    raise NoSolutionError(f"no equilibrium {'or cycle ' if cycles else ''}found: {'; '.join(tried)}.")


class _Flow(NamedTuple):
    """What is asked of a flow, of few states or of many."""

    given: Callable[[], Solution | None]  # the equilibrium that the given state is one of
    relaxed: Callable[[], Relaxed]
    solved: Callable[[Array], Solution | None]  # the equilibrium that Newton's method finds from a state


def _of_flow(
    flow: _Flow, u: Array, cycle: Callable[[Array], Iterator[FoundStart]] | None, tried: list[str]
) -> Iterator[FoundStart]:
    """cycle : from a state on or near one; None where cycles are not looked for."""
    here = flow.given()
    if here is not None:
        yield FoundStart(here, "given", "the given state is at rest")
    end = flow.relaxed()
    rest = flow.solved(end.u) if end.outcome == "rest" else None
    if rest is not None:
        kind = "" if end.stable else ", an unstable one"
        yield FoundStart(rest, "rest", f"simulated to rest{kind}, within t = {end.time:.3g}")
    tried.append(_words(end))
    if end.outcome == "moving" and cycle is not None:
        yield from cycle(end.u)
    for guess, what in ((end.u, "the end of the trajectory"), (end.mean, "its mean"), (u, "the given state")):
        found = None if guess is None or not np.all(np.isfinite(guess)) else flow.solved(guess)
        if found is not None:
            yield FoundStart(found, "newton", f"Newton's method from {what}; {'; '.join(tried)}")
    tried.append("Newton's method from there, its mean and the given state does not converge")


def _small(system: Any, u: Array, p: Array, periods: Array) -> _Flow:
    given, anywhere = (partial(_solved, system, p=p, periods=periods, near=near) for near in (AT_REST, None))
    return _Flow(lambda: given(u), lambda: relax(system, u, p), anywhere)


def _large(system: FunctionSystem, u: Array, p: Array) -> _Flow:
    def solved(guess: Array) -> LargeEquilibrium | None:
        with suppress(*_FAILURES):  # that is the answer: none
            return converge_large(system, guess, p)
        return None

    def given() -> LargeEquilibrium | None:
        here = solved(u)
        near = here is not None and float(np.max(np.abs(here.u - u) / sizes(system, u, p))) <= AT_REST
        return here if near else None

    return _Flow(given, lambda: relax_large(system, u, p, solved), solved)


def _cycle(system: Any, p: Array, periods: Array, tried: list[str], u: Array) -> Iterator[FoundStart]:
    """From a state on or near a cycle."""
    try:
        orbit = settled_orbit(system, u, p, periods, longest=LONGEST, budget=BUDGET)
        yield FoundStart(orbit, "cycle", "simulated to a cycle")
    except AtRestError as error:
        state = np.asarray(error.state, dtype=float)
        rest = _solved(system, state, p, periods, None)
        if rest is not None:
            yield FoundStart(rest, "rest", "simulated to rest")
        tried.append(f"no cycle from there ({_short(error)})")
    except _FAILURES as error:
        stiff = _stiff_cycle(system, u, p, periods) if isinstance(error, NotFiniteError) else None
        if stiff is not None:
            yield FoundStart(stiff, "cycle", "simulated to a cycle, by a method for stiff flows")
        tried.append(f"no cycle from there ({_short(error)})")


def _as_large(model: Any, u: Array, p: Array) -> FunctionSystem | None:
    """A flow whose Jacobian is sparse, or known by its products alone, and too large to be taken as a dense one."""
    if isinstance(model, FunctionProblem):
        one = None if model.method == "dense" else model
    else:
        one = sparse_function(model, u, p)
    return None if one is None or one.kind != "flow" or one.n <= SMALL else one.system()


def _stiff_cycle(system: Any, u: Array, p: Array, periods: Array) -> PeriodicOrbit | None:
    """The orbit next to one turn of a trajectory that the explicit method cannot follow."""
    if system.n_switches or periods.any():
        return None
    turn = stiff_loop(system, u, p)
    if turn is None:
        return None
    with suppress(*_FAILURES):  # that is the answer: none
        return orbit_from_samples(system, *turn, p, periods)
    return None


def _of_map(system: Any, u: Array, p: Array, periods: Array, tried: list[str]) -> Iterator[FoundStart]:
    here = _solved(system, u, p, periods, AT_REST)
    if here is not None:
        yield FoundStart(here, "given", "the given state is a fixed point")
    states = [u]
    for _ in range(ITERATES):
        states.append(system.value(states[-1], p))
        if not np.all(np.isfinite(states[-1])):
            tried.append("iterates of the given state leave the numbers")
            break
    else:
        size = np.maximum(np.abs(np.array(states)).max(axis=0), np.finfo(float).tiny)
        for length in range(1, LONGEST_CYCLE + 1):
            if float(np.max(np.abs(states[-1] - states[-1 - length]) / size)) < REPEATS:
                with suppress(*_FAILURES):  # the next way is tried
                    cycle = converge(system if length == 1 else iterate(system, length), states[-1], p, periods)
                    least = _least_period(system, cycle.u, p, length, size, periods)
                    if least < length:  # iterates that alternate about it repeat best after two
                        cycle = converge(system if least == 1 else iterate(system, least), cycle.u, p, periods)
                    words = "iterated to a fixed point" if least == 1 else f"iterated to a cycle of period {least}"
                    yield FoundStart(cycle, "rest" if least == 1 else "cycle", words)
        tried.append(f"iterates of the given state repeat after none of 1 to {LONGEST_CYCLE} steps")
    for guess in (states[-1], u):
        found = None if not np.all(np.isfinite(guess)) else _solved(system, guess, p, periods, None)
        if found is not None:
            yield FoundStart(found, "newton", f"Newton's method from the trajectory; {'; '.join(tried)}")
    tried.append("Newton's method from there does not converge")


def _least_period(system: Any, u: Array, p: Array, length: int, size: Array, periods: Array) -> int:
    """After how many steps a point of a cycle is back: a divisor of `length`."""
    turn = np.where(periods > 0.0, periods, np.inf)
    at = u
    for k in range(1, length):
        at = system.value(at, p)
        apart = at - u - np.where(periods > 0.0, periods * np.round((at - u) / turn), 0.0)
        if length % k == 0 and float(np.max(np.abs(apart) / size)) < SAME_POINT:
            return k
    return length


def _solved(system: Any, u: Array, p: Array, periods: Array, near: float | None) -> Equilibrium | None:
    """The equilibrium that Newton finds from u; `near`: only one as close as this."""
    full = np.append(p, 0.0) if system.is_forced else p
    if near is not None:
        f, matrix = system.jacobian(u, full)
        square = matrix[:, : system.n]
        f, square = (f - u, square - np.eye(system.n)) if system.kind == "map" else (f, square)
        size = np.maximum(np.abs(u), natural_metric(system, u, p).states)
        try:
            far = float(np.max(np.abs(np.linalg.solve(square, f)) / size))
        except np.linalg.LinAlgError:  # not isolated: where a trajectory leads is looked for
            return None
        if not far <= near:
            return None
    with suppress(*_FAILURES):  # that is the answer: none
        return converge(system, u, p, periods)
    return None


def is_singular(found: FoundStart) -> bool:
    """True where an equilibrium is not isolated, to rounding."""
    one = found.solution
    if not isinstance(one, Equilibrium) or one.system.is_forced:
        return False
    square = one.system.jacobian(one.u, one.p)[1][:, : one.system.n]
    square = square - np.eye(one.system.n) if one.system.kind == "map" else square
    size = np.maximum(np.abs(one.u), natural_metric(one.system, one.u, one.p).states)
    singular = np.linalg.svd(square * size / size[:, None], compute_uv=False)
    return bool(singular[-1] <= SINGULAR * singular[0])


def _by_deflation(model: Any, parameters: Record | None, tried: list[str]) -> FoundStart | None:
    try:
        found = [f for f in find_equilibria(model, None, parameters) if f.isolated]
    except ContinError as error:
        tried.append(f"the search of the box failed ({_short(error)})")
        return None
    if not found:
        tried.append("deflated Newton from starts all over the box finds none")
        return None
    best = next((f for f in found if f.stable), found[0])
    words = f"deflated Newton from starts in the box, the {'stable' if best.stable else 'first'} one of {len(found)}"
    return FoundStart(best.equilibrium, "deflation", f"{words}; {'; '.join(tried)}")


def _words(end: Relaxed) -> str:
    return {
        "rest": "the trajectory comes to rest where Newton's method does not converge",
        "moving": f"the trajectory does not come to rest within t = {end.time:.3g}",
        "escaped": f"the trajectory escapes by t = {end.time:.3g}",
        "failed": f"the trajectory cannot be followed beyond t = {end.time:.3g}",
    }[end.outcome]


def _short(error: BaseException) -> str:
    text = str(error).split(". ")[0]
    return text if len(text) <= 160 else text[:157] + "..."
