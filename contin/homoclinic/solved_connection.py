"""A connecting orbit solved for, on an interval and a mesh that fit it: where its curve starts."""

from __future__ import annotations

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.homoclinic.equations import ConnectionCurve
from contin.homoclinic.interval import fits, fitted
from contin.homoclinic.saddle_connections import ConnectionProblem
from contin.linalg.newton import Rules, newton
from contin.linalg.vectors import norm
from contin.problems.orbits.mesh.adaption import choose_mesh
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.two_parameters import UNBOUNDED

ROUNDS = 4  # of solving, until interval and mesh fit
AFAR = Rules(settled=1e-3, stalled=0.0, budget=40)  # steps of Newton's method from a guess, until they become shorter
LEAP = 0.5  # of its extent, by which a step moves a state at most
ZERO = 1e-6  # of its natural width: the value of a parameter that is smaller is zero to its error, and says no width


def solved_connection(curve: ConnectionCurve, arc: Profile, ends: Array, q: float, parent: Parent | None) -> Seed:
    """The connection solved for at fixed q (else p), on an interval and a mesh that fit it; `parent` : its origin."""
    source = "connection" if parent is None else f"{parent.branch}.{parent.label}"
    problem = ConnectionProblem(curve)
    orbits = curve.orbits
    if not curve.is_complete():
        raise InputError(
            f"{source}: {curve.stable_count} stable directions of the first and {curve.unstable_count} unstable ones "
            f"of the second saddle in {curve.n} dimensions: such a connection does not form curves in two parameters"
        )
    z = curve.join(arc, ends, q)
    sizes = orbits.state_sizes(arc)
    first, second = problem.widths(z, UNBOUNDED)
    own = natural_width(curve, z)
    first = first if first > ZERO * own else own
    own_mesh = False  # chosen for a solution on this interval: a guess has a kink where a tail begins
    for rounds_left in range(ROUNDS - 1, -1, -1):
        profile = curve.profile(z)
        scale = problem.scale_for(profile.h, sizes, first, second)
        solved = problem.at_held(z, scale)
        if solved is None and not problem.isolated:  # orbits that the first parameter does not move
            solved = problem.at_unknown(-1, z, arc.parameter, scale)
        if solved is None and problem.isolated:  # (else a parameter may go anywhere)
            near = _from_afar(problem, z, scale)
            solved = None if near is None else problem.at_held(near, scale)
        if solved is None:
            raise InputError(f"{source}: Newton's method for the connecting orbit, whole, did not converge")
        z, fitting = solved, fits(curve, solved, sizes)
        if rounds_left == 0 or (fitting and own_mesh):
            break
        own_mesh = fitting
        if not fitting:
            z = fitted(curve, z, sizes)
        if fitting or curve.node:  # (the long tail at a saddle-node needs a mesh at once)
            profile = curve.profile(z)
            chosen = choose_mesh(profile, sizes, orbits.tolerance, orbits.intervals)
            z = curve.join(profile.on_mesh(chosen.h), curve.equilibria(z), float(z[-2]))
    return Seed(problem, z, parent=parent)


def _from_afar(problem: ConnectionProblem, z: Array, scale: Array) -> Array | None:
    """Nearer to a connection by steps of Newton's method that move no state by more than half its extent.

    From a guess in leading order (a pulse by its envelope, samples of a simulation) whole steps grow, and lead to other
    connections or nowhere. None where steps do not become small (`AFAR`).
    """
    fixed = np.zeros(z.size)
    fixed[-1] = 1.0
    u = problem.curve.profile(z).u
    extent = np.tile(np.ptp(u, axis=0), len(u))
    extent[extent == 0.0] = np.inf  # a state at rest limits no step

    def correct(z: Array) -> tuple[float, Array] | None:
        here = problem.settled(z, scale).linearisation(z, fixed, scale)
        if here is None or here.sign == 0:
            return None
        step = here.solve(np.append(-here.residual, 0.0))
        longest = float(np.max(np.abs((scale * step)[: u.size]) / extent))
        return (norm(step), z + min(1.0, LEAP / longest) * scale * step) if np.isfinite(longest) else None

    found = newton(correct, z, AFAR)
    return None if found is None else found.at


def natural_width(curve: ConnectionCurve, z: Array) -> float:
    """The change of the first parameter that would change f by as much as it is along the connection; 0 for none."""
    u = curve.profile(z).u
    f, matrices = curve.orbits.system.jacobians(u, np.tile(curve.full_parameters(z), (len(u), 1)))
    by_parameter = np.abs(matrices[:, :, curve.n + curve.first]).max(axis=0)
    moved = by_parameter > 0.0
    return float(np.min(np.abs(f).max(axis=0)[moved] / by_parameter[moved], initial=np.inf)) if moved.any() else 0.0
