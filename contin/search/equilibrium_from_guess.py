"""From a guess to an equilibrium: damped Newton at fixed parameters, and what to say when it fails."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.continuation.told import Told
from contin.errors import ContinError, NoSolutionError, NotFiniteError
from contin.linalg.newton import longest_part
from contin.model.evaluate import evaluate
from contin.model.model import Model
from contin.problems.equilibria.algebraic import AlgebraicProblem
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.maps.cycle import CycleProblem
from contin.problems.surfaces.pseudo import Pseudo, boundary_equilibrium, pseudo_equilibrium, surface_at
from contin.problems.surfaces.sliding import Sliding
from contin.search.tolerances import ACCEPTABLE, ACCURATE
from contin.simulate.consistent import consistent_start
from contin.simulate.natural import natural_metric
from contin.systems.described import states_in_words
from contin.systems.iterate import IteratedSystem, sizes_along

if TYPE_CHECKING:
    from contin.systems.protocol import System

BUDGET = 60
FAR = 1e-6  # part of its size at the start below which a state is solved for once more, in its own size
AGAIN = 20  # times at most: from 1e120
TINY = 1e-12  # Newton steps shorter than this may be made of nothing but rounding
LOST = 8.0  # roundings of the terms of f, to which it may be zero
REAL = 1e-3  # relative difference of a state from the one that Newton's method finds from zero
RADII = (0.1, 0.5, 2.0, 10.0)  # around a start that fails, relative to it, and ...
STARTS = 8  # ... how many are tried within each
SHOWN = 12  # states in a message
NOT_AT_REST = (
    " The start lies on the surface {}, where the equations jump: motion does not rest there, and neither side has an "
    "equilibrium there."
)


@dataclass(frozen=True, eq=False, repr=False)
class Equilibrium(Told):
    """A solution of f(u, p) = 0 (or f(u, p) = u for a map) at fixed parameters: the start of a continuation."""

    system: System
    u: Array
    p: Array
    angle_periods: Array
    pseudo: Pseudo | None = None  # of a pseudo-equilibrium: the surface, and the system that slides on it

    def problem(self, parameter: str) -> EquilibriumProblem:
        """The continuation problem with this parameter free."""
        index = list(self.system.parameter_names).index(parameter)
        kind = AlgebraicProblem if self.system.kind == "algebraic" else EquilibriumProblem
        regular = kind(self.system, self.p, index, self.angle_periods)
        if self.pseudo is None:
            return regular
        return replace(regular, system=self.pseudo.system, sliding=Sliding(regular, self.pseudo.jump))

    def seed(self, parameter: str) -> Seed:
        """Where a continuation with this parameter free starts."""
        problem = self.problem(parameter)
        z = np.append(self.u, self.p[problem.active])
        if isinstance(self.system, IteratedSystem):
            cycle = CycleProblem(problem)
            return Seed(cycle, cycle.lift(z))
        return Seed(problem, z)

    def __str__(self) -> str:
        states = states_in_words(self.system.state_names, self.u, lambda k: f"= {self.u[k]:.10g}")
        if isinstance(self.system, IteratedSystem):
            return f"point {states} of a cycle of period {self.system.times}"
        if self.pseudo is not None:
            return f"pseudo-equilibrium {states} on the surface {self.pseudo.jump.surface.text}"
        return f"{'fixed point' if self.system.kind == 'map' else 'equilibrium'} {states}"


def converge(system: System, u: Array, p: Array, angle_periods: Array) -> Equilibrium:
    """Newton from u at fixed p, with the step halved while the (scaled) residual does not fall.

    Where that stalls, Powell's hybrid method (which may leave the Newton direction for the gradient) looks for a better
    guess. Raises NotFiniteError where the equations have no value at u (naming the equation), NoSolutionError with the
    residual history where no method converges, and with the nearest equilibrium that Newton finds from starts scattered
    around u, if there is one. On a surface where the equations of a flow jump, and beside one where nothing else is
    found, the solution is a pseudo-equilibrium, if motion slides there; where the equilibria of one side arrive at the
    surface, it is theirs.
    """
    u = _on_constraints(system, np.array(u, dtype=float), np.array(p, dtype=float))
    surface = surface_at(system, u, np.asarray(p, dtype=float))
    if surface is not None:
        there = _boundary(system, u, p, angle_periods) or _sliding(system, u, p, angle_periods)
        if there is not None:
            return there
    try:
        return _regular(system, u, p, angle_periods)
    except NoSolutionError as error:
        guess = _powell(EquilibriumProblem(system, np.array(p, dtype=float), 0, angle_periods), u)
        if guess is not None:
            with suppress(NoSolutionError, NotFiniteError):  # the failure of Newton's own is told below
                return _regular(system, guess, p, angle_periods)
        sliding = _sliding(system, u, p, angle_periods)
        if sliding is not None:
            return sliding
        nearest = _nearest(system, u, p, angle_periods)
        on = "" if surface is None else NOT_AT_REST.format(surface.surface.text)
        raise NoSolutionError(f"{error}{on} {_advice(system, nearest)}") from None


def _regular(system: System, u: Array, p: Array, angle_periods: Array) -> Equilibrium:
    """Newton's equilibrium; on a surface where the equations jump, at which their own value says nothing, the
    pseudo-equilibrium."""
    found = _newton(system, u, p, angle_periods)
    below = _below_lowest(system, found)
    if below:
        raise NoSolutionError(f"no equilibrium found from the start: {_states(system, found.u)} has {below}.")
    surface = surface_at(system, found.u, found.p, solved=True)
    if surface is None:
        return found
    sliding = _boundary(system, found.u, p, angle_periods) or _sliding(system, found.u, p, angle_periods)
    if sliding is None:
        raise NoSolutionError(
            f"no equilibrium found from the start: {_states(system, found.u)} lies on the surface "
            f"{surface.surface.text}, where the equations jump, and motion does not slide there."
        )
    return sliding


def _below_lowest(system: System, found: Equilibrium) -> str:
    """The state below the lowest value at which the equations have a meaning (an amplitude's 0), in words."""
    model = getattr(system, "model", None)
    if not isinstance(model, Model):
        return ""
    values = dict(zip(system.parameter_names, found.p.tolist(), strict=True))
    for state, value in zip(model.states, found.u.tolist(), strict=True):
        lowest = None if state.minimum is None else float(evaluate(state.minimum, values))
        if lowest is not None and value < lowest - FAR * (abs(value) + abs(lowest)):
            return f"{state.name} below its lowest value {lowest:.6g}"
    return ""


def _sliding(system: System, u: Array, p: Array, angle_periods: Array) -> Equilibrium | None:
    """The pseudo-equilibrium on a surface that motion slides on next to u."""
    base = np.array(p, dtype=float)
    pseudo = pseudo_equilibrium(system, u, base, lambda slid, at: _newton(slid, at, base, angle_periods).u)
    return None if pseudo is None else Equilibrium(system, pseudo.u, base, angle_periods, pseudo)


def _boundary(system: System, u: Array, p: Array, angle_periods: Array) -> Equilibrium | None:
    """The equilibrium of one side of a surface through u that lies on it."""
    base = np.array(p, dtype=float)
    found = boundary_equilibrium(system, u, base, lambda side, at: _newton(side, at, base, angle_periods).u)
    return None if found is None else Equilibrium(system, found.u, base, angle_periods)


def _on_constraints(system: System, u: Array, p: Array) -> Array:
    """The guess with algebraic states that fit it, where there are any."""
    with suppress(NoSolutionError):  # Newton's method on all equations may reach them from elsewhere
        return consistent_start(system, u, p)
    return u


def _nearest(system: System, u: Array, p: Array, angle_periods: Array) -> Array | None:
    """The equilibrium closest to u among those that Newton reaches from starts scattered around it."""
    generator = np.random.default_rng(5)
    size = np.where(u == 0.0, float(np.abs(u).max(initial=0.0)) or 1.0, np.abs(u))
    found: list[Array] = []
    for radius in RADII:
        for _ in range(STARTS):
            with suppress(NoSolutionError, NotFiniteError, np.linalg.LinAlgError):  # one of many starts
                start = u + radius * size * generator.uniform(-1.0, 1.0, len(u))
                found.append(_regular(system, start, p, angle_periods).u)
        if found:
            distances = [float(np.max(np.abs(v - u) / size)) for v in found]
            return found[distances.index(min(distances))]
    return None


def _advice(system: System, nearest: Array | None) -> str:
    if nearest is None:
        return "No equilibrium was found around the start either; give another start, or other parameters."
    return f"The nearest equilibrium found is {_states(system, nearest)}; start there, or give other parameters."


def _states(system: System, u: Array) -> str:
    names = system.state_names or tuple(f"u{k}" for k in range(len(u)))
    listed = ", ".join(f"{n} = {v:.6g}" for n, v in zip(names[:SHOWN], u[:SHOWN], strict=True))
    return f"{listed}, ..." if len(u) > SHOWN else listed


def _newton(system: System, u: Array, p: Array, angle_periods: Array, again: int = AGAIN) -> Equilibrium:
    problem = EquilibriumProblem(system, np.array(p, dtype=float), 0, angle_periods)
    n = problem.n

    def evaluate(state: Array) -> tuple[Array, Array]:
        f, matrix = problem.linearise(np.append(state, problem.base[0]))
        return f, matrix[:, :n]

    f, a = evaluate(u)
    if not np.all(np.isfinite(f)):
        raise NotFiniteError(system.why_not_finite(u, problem.base) or "the equations are not finite at the start")
    history = [float(np.max(np.abs(f)))]
    scale = _scale_at(system, u, problem.base)
    best_u, best = u, history[0]
    before = np.inf

    def solution(state: Array) -> Equilibrium:
        cleared = _without_rounding(evaluate, state, scale)
        if again and np.any(_scale_at(system, cleared, problem.base) < FAR * scale):
            try:  # the start's sizes say nothing of accuracy
                return _newton(system, cleared, p, angle_periods, again - 1)
            except NoSolutionError:
                f_there, a_there = evaluate(cleared)
                last = _newton_step(a_there, f_there, scale)
                if last is None or not _is_rounding(lambda v: evaluate(v)[0], cleared, f_there, last, scale):
                    raise
        return Equilibrium(system, cleared, problem.base, angle_periods)

    for _ in range(BUDGET):
        if history[-1] == 0.0:
            return solution(u)
        step = _newton_step(a, f, scale)
        if step is None:
            if _is_lost_in_its_terms(system, u, problem.base, f):
                return solution(u)
            break
        size = float(np.max(np.abs(step) / np.maximum(scale, np.abs(u))))
        if size < ACCURATE or (size >= 0.5 * before and before < ACCEPTABLE):
            return solution(u + step if size < before else u)
        accepted = _damped(evaluate, u, a, step, scale)
        if accepted is None:
            rounding = _is_rounding(lambda state: evaluate(state)[0], u, f, step, scale)
            if rounding or _is_lost_in_its_terms(system, u, problem.base, f):
                return solution(u)
            break
        u, f, a, damping = accepted
        before = size if damping == 1.0 else np.inf
        history.append(float(np.max(np.abs(f))))
        if history[-1] < best:
            best_u, best = u, history[-1]
    raise NoSolutionError(_failure(system, history, best_u, best))


def _damped(
    evaluate: Callable[[Array], tuple[Array, Array]], u: Array, a: Array, step: Array, scale: Array
) -> tuple[Array, Array, Array, float] | None:
    """(state, f, Jacobian, damping) after the longest part of a Newton step that brings the solution nearer."""
    unit = np.maximum(scale, np.abs(u))

    def look(part: float) -> tuple[float, tuple[Array, Array, Array]] | None:
        trial = u + part * step
        f, matrix = evaluate(trial)
        ahead = _newton_step(a, f, scale) if np.all(np.isfinite(f)) and np.all(np.isfinite(matrix)) else None
        return None if ahead is None else (float(np.max(np.abs(ahead) / unit)), (trial, f, matrix))

    found = longest_part(look, float(np.max(np.abs(step) / unit)), ACCEPTABLE)
    return None if found is None else (*found[1], found[0])


def _scale_at(system: System, u: Array, p: Array) -> Array:
    """Sizes of the states at u; one that is zero with rounding errors beside others tells nothing."""
    natural, own = natural_metric(system, u, p).states, sizes_along(system, u, p)
    largest = float(own.max(initial=0.0))
    return np.maximum(own, np.maximum(1e-3 * largest, 1e-15 * natural)) if largest > 0.0 else natural


def _powell(problem: EquilibriumProblem, u: Array) -> Array | None:
    """A better guess, or None where the method finds none."""
    from scipy.optimize import root

    n = problem.n
    size = float(np.abs(u).max(initial=0.0)) or 1.0
    scale = np.where(u == 0.0, size, np.abs(u))

    def scaled(y: Array) -> tuple[Array, Array]:
        f, matrix = problem.linearise(np.append(scale * y, problem.base[0]))
        return f / scale, matrix[:, :n] * scale / scale[:, None]

    try:
        found = root(scaled, u / scale, jac=True, method="hybr")
    except (ContinError, ArithmeticError, ValueError, np.linalg.LinAlgError):
        return None  # no better guess: Newton's own failure is told
    guess: Array = scale * found.x
    return guess if found.success and np.all(np.isfinite(guess)) else None


def _is_rounding(function: Callable[[Array], Array], u: Array, f: Array, step: Array, scale: Array) -> bool:
    """True where f at u is only rounding: a thousand (tiny) Newton steps back, it is linear all the same."""
    if not np.all(np.abs(step) <= TINY * np.maximum(scale, np.abs(u))):
        return False
    back = function(u - 1000.0 * step)
    return bool(np.max(np.abs(back - 1001.0 * f)) <= 0.1 * np.max(np.abs(1001.0 * f)))


def _is_lost_in_its_terms(system: System, u: Array, p: Array, f: Array) -> bool:
    """True where f at u is no more than rounding errors of its terms, as at a fold, where Newton's steps are large."""
    full = np.append(p, 0.0) if system.is_forced else p
    own = sizes_along(system, u, full)
    values = np.abs(np.concatenate([own, full]))
    terms = np.abs(np.asarray(system.jacobian(u, full)[1])) @ values + (own if system.kind == "map" else 0.0)
    return bool(np.all(np.abs(f) <= LOST * np.finfo(float).eps * terms))


def _without_rounding(evaluate: Callable[[Array], tuple[Array, Array]], u: Array, scale: Array) -> Array:
    """u with zeros where a state is smaller than Newton's accuracy and only rounding.

    A metric in which 1e-34 is the size of a state would stop the run at its first step. A state that really is that
    small is one to which Newton's method comes back from zero.
    """
    tiny = (u != 0.0) & (np.abs(u) < ACCURATE * scale)
    if not tiny.any():
        return u
    cleared = np.where(tiny, 0.0, u)
    f, a = evaluate(cleared)
    step = _newton_step(a, f, scale) if np.all(np.isfinite(f)) and np.all(np.isfinite(a)) else None
    if step is None:
        return u
    real = np.abs(cleared + step - u) <= REAL * np.abs(u)
    return np.where(tiny & ~real, 0.0, u)


def _newton_step(a: Array, f: Array, scale: Array) -> Array | None:
    matrix = a * scale / scale[:, None]
    try:
        step = np.linalg.solve(matrix, -f / scale)
    except np.linalg.LinAlgError:
        step = np.linalg.lstsq(matrix, -f / scale, rcond=1e-12)[0]
        if np.linalg.norm(matrix @ step + f / scale) > 0.5 * np.linalg.norm(f / scale):
            return None  # no direction reduces the residual: a minimum of |f| that is no solution
    return scale * step if np.all(np.isfinite(step)) else None


def _failure(system: System, history: list[float], u: Array, residual: float) -> str:
    shown = " -> ".join(f"{r:.1e}" for r in ([*history[:3], *history[-2:]] if len(history) > 5 else history))
    return (
        f"no equilibrium found from the start: residual {shown} after {len(history) - 1} Newton steps, smallest at "
        f"{_states(system, u)} (residual {residual:.1e})."
        + (
            " With `start: auto` a start is looked for, first where the state comes to rest."
            if system.kind == "flow"
            else ""
        )
    )
