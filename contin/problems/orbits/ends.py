"""Where a family of periodic orbits ends: it shrinks to a Hopf point, or its period grows without bound at a saddle."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.problem import Frame, Sample, Verified
from contin.continuation.settings import Settings
from contin.problems.orbits.invariant_circle import invariant_circle
from contin.problems.orbits.layout import Profile
from contin.problems.orbits.problem import dwelling

SMALL = 0.12  # amplitude (relative to the states' sizes) below which a shrinking orbit may end at a Hopf point
MISSED = 0.5  # ... and its distance from where the amplitude's fall foretells that point, relative to what remains
VERTICAL = 1e-6  # ... or relative to the range
STILL = 1e-10  # dp/ds (scaled) below which the parameter stands still
GROWN = 1e8  # ... and the amplitude up to which orbits are followed then
LINGERING = 0.3  # part of the period spent near equilibria from which an approach to a homoclinic orbit is looked for
REACHED = 2e-9  # distance of the parameter from its limit, relative to its range, at which the approach is complete
AGREED = 1e-9  # ... or at which two extrapolations agree to this
AGREED_SPIRAL = 1e-7  # ... with complex leading eigenvalues, where infinitely many folds accumulate
SWINGING = 6.0  # the error estimate's factor of safety there
DOUBTFUL = 1e-4  # ... above which the extrapolation is not tried
NOISE = 1e-7  # ... below which it is accepted where two extrapolations differ by more than what remains
PRECISE = Settings(tolerance=1e-11)
NEAR_SADDLE = 0.1  # of the orbit's extent: how close the slowest point must be to its equilibrium
SLOW = 0.05  # speed relative to the mean below which an orbit dwells


@dataclass(frozen=True, eq=False)
class Ending:
    """The end, a last row and a labelled point for it."""

    end: End
    last: Sample | None = None
    point: Verified | None = None


def ending(problem: Any, origin: Sample, before: Sample | None, frame: Frame) -> Ending | None:
    """The end that an orbit has reached, or None."""
    if before is None:
        return None
    found = shrunk(problem, origin, before, frame) or unbounded(problem, origin, frame)
    if found is not None or not problem.autonomous:
        return found
    if dwelling(problem.profile(origin.z), problem.sizes(origin.z, frame.scale)) < LINGERING:
        return None
    found = diverged(problem, origin, before, frame)
    if found is None:
        circle = invariant_circle(problem, origin, before, frame)
        found = None if circle is None else Ending(circle[0], None, circle[1])
    return found


def _extent(profile: Profile, sizes: Array) -> float:
    return float(np.max(np.ptp(profile.u, axis=0) / sizes))


def unbounded(problem: Any, origin: Sample, frame: Frame) -> Ending | None:
    """Orbits of a linear centre, all at one parameter, grow for ever."""
    if abs(float(origin.tangent[-1])) > STILL:
        return None
    profile = problem.profile(origin.z)
    usual = 1.0 if problem.origin is None else max(1.0, float(np.abs(problem.origin[1]).max()))
    largest = int(np.argmax(np.ptp(profile.u, axis=0)))
    if float(np.ptp(profile.u[:, largest])) < GROWN * usual:
        return None
    name, state = problem.parameters[0], problem.system.state_names[largest]
    at = profile.parameter if abs(profile.parameter) > STILL * float(frame.scale[-1]) else 0.0
    text = f"the orbits of this family all exist at {name} = {at:.10g}, and {state} grows without bound"
    return Ending(End("bound", text, {"value": at}))


def _foretold(profile: Profile, earlier: Profile, sizes: Array) -> float:
    """Where the square of the amplitude, linear in the parameter beside a Hopf point, vanishes."""
    now, then = _extent(profile, sizes) ** 2, _extent(earlier, sizes) ** 2
    return profile.parameter - now * (profile.parameter - earlier.parameter) / (now - then)


def shrunk(problem: Any, origin: Sample, before: Sample, frame: Frame) -> Ending | None:
    """The Hopf point on which a family with falling amplitude closes."""
    from contin.problems import defining
    from contin.problems.equilibrium import EquilibriumProblem

    profile, sizes = problem.profile(origin.z), problem.sizes(origin.z, frame.scale)
    size = _extent(profile, sizes)
    if problem.winding.any() or not problem.autonomous or size > SMALL:
        return None
    earlier = problem.profile(before.z)
    if size >= _extent(earlier, sizes):
        return None
    rest = EquilibriumProblem(problem.system, problem.base.copy(), problem.active)
    centre = profile.weights @ profile.u
    z = rest.at_parameter(np.append(centre, profile.parameter), profile.parameter, np.append(sizes, frame.scale[-1]))
    if z is None:
        return None
    metric = np.append(np.sqrt(problem.n) * sizes, frame.scale[-1])
    local = rest.scaled(metric)
    omega = 2.0 * np.pi / profile.period
    solved = defining.critical_pair(local, z / metric, lambda w: 1j * w, lambda w: 1j, omega)
    if solved is None or solved.residual > 1e-8:
        return None
    found = solved.y * metric
    remaining = abs(float(found[-1]) - profile.parameter)
    missed = abs(float(found[-1]) - _foretold(profile, earlier, sizes))
    if missed > MISSED * remaining + VERTICAL * float(frame.scale[-1]):
        return None
    frequency = abs(float(solved.extra[0]))
    if abs(frequency - omega) > 0.2 * omega or float(np.linalg.norm(solved.y - z / metric)) > 2.0 * size:
        return None
    point = replace(
        profile, u=np.tile(found[:-1], (len(profile.u), 1)), period=2.0 * np.pi / frequency, parameter=float(found[-1])
    )
    values = np.linalg.eigvals(rest.linear_part(found))
    order = np.argsort(np.minimum(np.abs(values - 1j * frequency), np.abs(values + 1j * frequency)))
    others = values[order[2:]]
    with np.errstate(over="ignore"):
        multipliers = np.concatenate([[1.0, 1.0], np.exp(others * point.period)]).astype(complex)
    name = problem.parameters[0]
    where = ", ".join(f"{s} = {v:.10g}" for s, v in zip(problem.system.state_names, found[:-1], strict=True))
    text = f"the orbits shrink to the Hopf point at {name} = {found[-1]:.12g} ({where}), period {point.period:.10g}"
    end = End("hopf", text, {"at": {name: float(found[-1])}, "error": solved.error * float(frame.scale[-1])})
    last = Sample(point.vector(), origin.tangent, origin.tests, int(np.sum(others.real > 0)), multipliers)
    return Ending(end, last)


@dataclass(frozen=True, eq=False)
class Saddle:
    """An equilibrium that the orbit lingers at."""

    u: Array
    eigenvalues: NDArray[np.complex128]
    visits: int

    @property
    def leading(self) -> complex:
        """The leading eigenvalue, stable or unstable, with the slower rate; the upper one of a pair."""
        real = self.eigenvalues.real
        rate = min(real[real > 0].min(), -real[real < 0].max())
        candidates = self.eigenvalues[np.abs(np.abs(real) - rate) <= 1e-9 * rate]
        return complex(max(candidates, key=lambda v: v.imag))

    def at(self, problem: Any, parameter: float, sizes: Array) -> Saddle:
        """The same equilibrium at another parameter value."""
        found = _equilibrium(problem, self.u, parameter, sizes)
        return self if found is None else replace(self, u=found[0], eigenvalues=found[1])

    @property
    def quantity(self) -> float:
        """Saddle quantity: leading unstable plus leading stable real part; negative: a stable cycle (n = 2)."""
        real = self.eigenvalues.real
        return float(real[real > 0].min() + real[real < 0].max())


def diverged(problem: Any, origin: Sample, before: Sample, frame: Frame) -> Ending | None:
    """The homoclinic or heteroclinic orbit that a family with growing period approaches.

    With v visits of saddles with leading rates r, p - p* = A exp(-k T), 1 / k = sum of 1 / r over the visits, so
    p* = p + (dp/dT) / k. Where the leading eigenvalues are r +- i w, p - p* = A exp(-k T) cos(q T + c), q = k w / r,
    and p* = p + (p'' + 2 k p') / (k^2 + q^2). Slopes are those of the tangents. The limit is believed when two orbits
    agree on it and the remaining distance is small.
    """
    profile, sizes = problem.profile(origin.z), problem.sizes(origin.z, frame.scale)
    position = profile.u.size
    earlier = problem.profile(before.z)
    gained = profile.period - earlier.period
    if not gained > 0.0:
        return None
    saddles = saddles_near(problem, profile, sizes)
    if not saddles:
        return None
    k = 1.0 / sum(s.visits / abs(s.leading.real) for s in saddles)
    q = k * max(s.leading.imag / abs(s.leading.real) for s in saddles)
    slopes = []
    for sample in (origin, before):
        exact = problem.probe(sample, 0.0, sample.z, frame, PRECISE)  # the march's tangents are not exact enough here
        if exact is None or exact.tangent[position] == 0.0:
            return None
        raw = exact.tangent * frame.scale
        slopes.append(float(raw[-1] / raw[position]))
    width = float(frame.scale[-1])
    moved = profile.parameter - earlier.parameter
    if q > 0.0:
        bends = (
            (4.0 * slopes[0] + 2.0 * slopes[1]) / gained - 6.0 * moved / gained**2,
            -(2.0 * slopes[0] + 4.0 * slopes[1]) / gained + 6.0 * moved / gained**2,
        )
        steps = [(bend + 2.0 * k * slope) / (k * k + q * q) for bend, slope in zip(bends, slopes, strict=True)]
    else:
        steps = [slope / k for slope in slopes]
    limits = profile.parameter + steps[0], earlier.parameter + steps[1]
    remaining = abs(steps[0])
    if remaining > DOUBTFUL * width:
        return None
    drift = abs(limits[0] - limits[1])
    error = drift * max(1.0, remaining / abs(moved)) if moved != 0.0 else drift
    settled = abs(moved) > 1e-3 * remaining and error < (AGREED_SPIRAL if q > 0.0 else AGREED) * width
    if not (settled or remaining < REACHED * width or (drift > remaining and remaining < NOISE * width)):
        return None
    at_limit = [s.at(problem, limits[0], sizes) for s in saddles]
    doubt = (SWINGING if q > 0.0 else 3.0) * error
    return _connection(problem, origin, profile, at_limit, limits[0], doubt + 2e-11 * width)


def saddles_near(problem: Any, profile: Profile, sizes: Array) -> list[Saddle]:
    """Hyperbolic saddles that the orbit comes close to, each with the number of its visits in a period."""
    extent = _extent(profile, sizes)
    found: list[Saddle] = []
    for u in _slowest_points(profile, sizes):
        near = _equilibrium(problem, u, profile.parameter, sizes)
        if near is None or float(np.max(np.abs(near[0] - u) / sizes)) > NEAR_SADDLE * extent:
            return []
        state, values = near
        if not (np.any(values.real > 0) and np.any(values.real < 0)):
            return []
        if float(np.abs(values.real).min()) < 1e-6 * float(np.abs(values).max()):
            return []
        for k, known in enumerate(found):
            if float(np.max(np.abs(_apart(problem, known.u, state)) / sizes)) < 1e-6:
                found[k] = replace(known, visits=known.visits + 1)
                break
        else:
            found.append(Saddle(state, values, 1))
    return found


def _equilibrium(
    problem: Any, u: Array, parameter: float, sizes: Array
) -> tuple[Array, NDArray[np.complex128]] | None:
    """The equilibrium near u and its eigenvalues by falling real part."""
    from contin.problems.equilibrium import EquilibriumProblem

    rest = EquilibriumProblem(problem.system, problem.base.copy(), problem.active)
    z = rest.at_parameter(np.append(u, parameter), parameter, np.append(sizes, 1.0))
    if z is None:
        return None
    values = np.linalg.eigvals(rest.linear_part(z))
    return z[:-1], values[np.argsort(-values.real)].astype(complex)


def _slowest_points(profile: Profile, sizes: Array) -> list[Array]:
    """The slowest node of every stretch of the orbit (a closed curve) that is passed slowly."""
    steps = np.linalg.norm(np.diff(profile.u, axis=0) / sizes, axis=1)
    speed = steps / np.diff(profile.times)
    slow = speed < SLOW * float(steps.sum())
    if slow.all() or not slow.any():
        return []
    first = int(np.argmin(slow))  # begin on a fast stretch
    order = np.roll(np.arange(len(speed)), -first)
    points: list[Array] = []
    run: list[int] = []
    for k in [*order.tolist(), int(order[0])]:
        if slow[k] and not (run and k == order[0]):
            run.append(k)
        elif run:
            points.append(profile.u[min(run, key=lambda j: speed[j])])
            run = []
    return points


def _connection(
    problem: Any, origin: Sample, profile: Profile, saddles: list[Saddle], limit: float, error: float
) -> Ending:
    name, names = problem.parameters[0], problem.system.state_names
    data: dict[str, Any] = {"at": {name: limit}, "error": error, "spiral": any(s.leading.imag > 0.0 for s in saddles)}
    kind = "homoclinic" if len(saddles) == 1 else "heteroclinic"
    states = [{k: _rounded(v, s.u) for k, v in zip(names, s.u, strict=True)} for s in saddles]
    described = ["(" + ", ".join(f"{k} = {v:.8g}" for k, v in state.items()) + ")" for state in states]
    if len(saddles) == 1:
        data |= {"saddle": states[0], "eigenvalues": saddles[0].eigenvalues, "saddle_quantity": saddles[0].quantity}
        data["passes"] = saddles[0].visits
    else:
        data["saddles"] = [
            {"state": state, "eigenvalues": s.eigenvalues, "saddle_quantity": s.quantity}
            for state, s in zip(states, saddles, strict=True)
        ]
    text = (
        f"the period grows without bound (here {profile.period:.6g}): {kind} orbit at {name} = {limit:.12g} "
        f"+- {error:.1e}, "
        f"saddle{'s' if len(saddles) > 1 else ''} {', '.join(described)}"
    )
    point = Verified(
        "HOM", origin.z, float(abs(limit - profile.parameter)), error, origin.eigenvalues, origin.unstable,
        normal_form={"at": {name: limit}} | ({"kind": kind} if kind == "heteroclinic" else {}),
    )  # fmt: skip
    return Ending(End(kind, text, data), None, point)


def _rounded(value: float, state: Array) -> float:
    """Zero for what is rounding beside the state's other entries (and 1)."""
    return float(value) if abs(value) > 1e-13 * max(1.0, float(np.abs(state).max())) else 0.0


def turns(problem: Any, difference: Array) -> Array:
    """The whole turns of angles in a difference of states (rows of them); 0 for other states."""
    periods = np.asarray(problem.system.model.periods(problem.constants()), dtype=float)
    count = np.round(difference / np.where(periods > 0.0, periods, 1.0))
    return np.asarray(np.where(periods > 0.0, count * periods, 0.0))


def _apart(problem: Any, u: Array, v: Array) -> Array:
    return np.asarray(u - v - turns(problem, u - v))
