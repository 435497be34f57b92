"""Special points of equilibria and fixed points: what a change between two samples means, and its verification."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation.outcome import NOTHING, Outcome, Rejected, Verified, unverified
from contin.continuation.sample import Frame, Sample, opposite
from contin.linalg.balancing import balancing_scales
from contin.linalg.spectrum import noises, spectrum
from contin.machine import elementary
from contin.problems.coinciding import with_hopf_points_told
from contin.problems.equilibria import defining
from contin.problems.equilibria.branching.multiple_kernel import reduced_branches
from contin.problems.equilibria.branching.rotated import turning_kernel
from contin.problems.equilibria.colliding_pairs import colliding
from contin.problems.equilibria.scaled import ScaledSystem
from contin.problems.equilibria.solved_to_rounding import Solved
from contin.problems.neutral_pairs import errors_of, is_suspect
from contin.problems.tolerances import CRITICAL, RESIDUAL_LIMIT
from contin.systems.accuracy import accuracy_of_equations

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations

CONSISTENT = 20.0  # a residual that exceeds its own rounding errors by more than this factor satisfies nothing
UNSURE = 1e-11  # scaled: a fold that is known no better may be a branch point
NEXT = 1e-4  # scaled: how far from it a multiple zero may be found
SINGULAR = 1e-7  # a singular value this small beside the Jacobian's size counts for the dimension of a kernel
ROUNDED = 1e-14  # ... and one this small is zero with rounding errors
SETTLED = 1e-14  # scaled: a step this short is rounding
CENTRE = 1e-11  # a pair this close to the boundary on both sides of a point stays there
MUTUAL = 1e-8  # two states act on each other: product of their couplings beside the largest such product
BESIDE = 1e-2  # where the size is measured too (along the branch): at a multiple branch point all of F_u may vanish

Critical = Callable[[Vector], list[int]]  # which of the eigenvalues are the critical ones


def explain(is_map: bool, a: Sample, b: Sample) -> tuple[str, ...] | None:
    """Event types that account for every sign change of a test and for the change of the unstable count.

    The two are independent: a fold or branch point moves one real eigenvalue through the critical value, a Hopf or
    Neimark-Sacker point two. A branch point where the parameter turns (a pitchfork seen from its side branch) moves
    none or one. None means that one simple event does not account for it all.
    """
    seen = tuple(opposite(a.tests, b.tests).tolist())
    moved = abs(b.unstable - a.unstable)
    if seen == (False, False, False, False):
        return () if moved == 0 else None
    if seen == (True, False, False, False):
        return ("LP",) if moved == 1 else None
    if seen == (False, True, False, False):
        return ("BP",) if moved == 1 else None
    if seen == (True, True, False, False):
        return ("BP",) if moved <= 1 else None
    if seen == (False, False, True, False):
        if moved == 0:
            return ("neutral",)
        return ("NS" if is_map else "HB",) if moved == 2 else None
    if seen == (False, False, False, True):
        return ("PD",) if moved == 1 else None
    return None


def verify(problem: AlgebraicEquations, type_: str, near: Sample, frame: Frame) -> Outcome:
    """Solve the defining system of a simple event; NOTHING where there is nothing to report."""
    pair = nearest_pair(near.eigenvalues, problem.is_map) if type_ not in ("LP", "BP", "PD") else None
    is_real = pair is None or abs(pair.imag) <= 1e-9 * abs(pair)
    if type_ == "neutral" and not is_real:
        return Rejected("a pair of eigenvalues touches the stability boundary without a change of the unstable count")
    frame, tangent = _balanced_frame(problem, near, frame)
    y = near.z / frame.scale
    local = ScaledSystem(problem, frame.scale).rated(y)
    if type_ == "LP":
        return _fold(problem, local, y, frame)
    if type_ == "BP":
        return _branch_point(problem, local, y, frame, 1, tangent)
    if type_ == "PD":
        return _flip(problem, local, y, frame, 1)
    if type_ == "neutral":
        return _opposite_zeros(problem, local, y, frame, tangent)
    if problem.is_map and pair is not None and abs(pair + 1.0) < NEXT:  # both are real, or nearly
        flips = _flip(problem, local, y, frame, 2)
        if isinstance(flips, Verified):
            return flips
    if pair is None or is_real:
        return Rejected(f"{type_}: the two eigenvalues that cross are real")
    return _crossing_pair(problem, local, y, frame, pair, tangent)


def _balanced_frame(problem: AlgebraicEquations, sample: Sample, frame: Frame) -> tuple[Frame, Array]:
    """The metric in which F_u at the sample is balanced, and the sample's unit tangent in it.

    Defining systems are solved there, so that a badly guessed scale of a state costs no accuracy.
    """
    local, y = ScaledSystem(problem, frame.scale), sample.z / frame.scale
    jacobians = local.linearised(np.array([y, y + BESIDE * sample.tangent]))[1]  # at the point couplings may vanish
    if not np.isfinite(jacobians).all():
        return frame, sample.tangent
    units = _balancing_units(local, *jacobians)
    tangent = sample.tangent / units
    return Frame(frame.scale * units, frame.reference), tangent / np.linalg.norm(tangent)


def _fold(problem: AlgebraicEquations, local: ScaledSystem, y: Array, frame: Frame) -> Outcome:
    """A fold, unless its error does not tell it from a branch point: there its defining system has a solution too."""
    solved = defining.fold(local, y)
    if solved is not None and solved.error > UNSURE:
        crossing = defining.branch_point(local, solved.y, 1)
        if crossing is not None and crossing.residual <= RESIDUAL_LIMIT:
            apart = abs(float(crossing.y[-1] - solved.y[-1]))
            if apart <= solved.error + crossing.error and crossing.error < solved.error:
                return NOTHING
    return _accept(problem, "LP", frame, solved, _real_critical(problem))


def _flip(problem: AlgebraicEquations, local: ScaledSystem, y: Array, frame: Frame, count: int) -> Outcome:
    """A period doubling, of so many multipliers that pass -1 together."""

    def critical(values: Vector) -> list[int]:
        return list(np.argsort(np.abs(values + 1.0))[:count])

    found = _accept(problem, "PD", frame, defining.eigenvalue_at(local, y, -2.0, count), critical)
    return _with(found, vectors={"kernel": count}) if isinstance(found, Verified) and count > 1 else found


def _opposite_zeros(
    problem: AlgebraicEquations, local: ScaledSystem, y: Array, frame: Frame, tangent: Array
) -> Outcome:
    """Two real eigenvalues with zero sum: a neutral saddle, or both vanish, crossing zero in opposite senses."""
    here, there = _singular_values(local, *local.linearised(np.array([y, y + BESIDE * tangent]))[1])
    if len(here) < 2 or here[-2] > 2e-2 * there[-2]:
        return NOTHING
    found = _branch_point(problem, local, y, frame, 2, tangent)
    return found if isinstance(found, Verified) else NOTHING


def nearest_pair(values: Vector, is_map: bool) -> complex | None:
    """The eigenvalue (Im >= 0) of the pair nearest to the stability boundary; None where there is no pair."""
    best, chosen = np.inf, None
    for i in range(len(values)):
        for j in range(i + 1, len(values)):
            a, b = values[i], values[j]
            gap = abs(a * b - 1) / (1 + abs(a * b)) if is_map else abs(a + b) / max(abs(a) + abs(b), 1e-300)
            if gap < best:
                best, chosen = gap, (a if a.imag >= 0 else b)
    return None if chosen is None else complex(chosen)


def _crossing_pair(
    problem: AlgebraicEquations, local: ScaledSystem, y: Array, frame: Frame, pair: complex, tangent: Array,
    corank: int = 1
) -> Outcome:  # fmt: skip
    """A Hopf or Neimark-Sacker point, or why there is none: two pairs may meet on the boundary."""
    found = _oscillatory(problem, local, y, frame, pair, tangent, corank)
    if not isinstance(found, Rejected):
        return found
    return colliding(spectrum(problem.linear_part(y * frame.scale))[0], pair, problem.is_map) or found


def _oscillatory(
    problem: AlgebraicEquations, local: ScaledSystem, y: Array, frame: Frame, pair: complex, tangent: Array,
    corank: int = 1
) -> Outcome:  # fmt: skip
    """A Hopf point (pair = +-i w) or a Neimark-Sacker point (pair = exp(+-i w)); corank pairs may coincide."""
    if _critical_throughout(problem, local, y, pair, tangent, corank):
        return NOTHING
    if problem.is_map:
        angle = float(elementary.angle(pair))
        solved = defining.critical_pair(
            local, y, lambda w: elementary.exp(1j * w) - 1.0, lambda w: 1j * elementary.exp(1j * w), angle, corank
        )
    else:
        angle = abs(pair.imag)
        solved = defining.critical_pair(local, y, lambda w: 1j * w, lambda w: 1j, angle, corank)
    type_ = "NS" if problem.is_map else "HB"
    if solved is None:
        return unverified(type_, "Newton on its defining system did not converge")
    frequency = abs(float(solved.extra[0]))
    if abs(frequency - angle) > 0.3 * angle:
        return unverified(type_, f"the frequency moved from {angle:.3g} to {frequency:.3g}")
    target = elementary.exp(1j * frequency) if problem.is_map else 1j * frequency
    accepted = _accept(
        problem, type_, frame, solved, lambda values: _nearest(values, (target, np.conj(target)) * corank)
    )
    if isinstance(accepted, Verified):
        return _with(accepted, vectors={"omega": frequency, "kernel": corank})
    return accepted


def _with(point: Verified, **changes: Any) -> Verified:
    return replace(point, **changes)


def _beside(local: ScaledSystem, y: Array, tangent: Array) -> Iterator[Array | None]:
    """Points of the curve on both sides of y, even where J is singular all along; None where there is none."""
    for side in (-BESIDE, BESIDE):
        at = y + side * tangent
        for _ in range(4):  # minimum-norm Newton steps, which singular Jacobians do not disturb
            f, jacobian = local.linearise(at)
            if not (np.isfinite(f).all() and np.isfinite(jacobian).all()):
                yield None
                return
            step = np.linalg.lstsq(jacobian, f, rcond=1e-6)[0]
            at = at - step
            if np.abs(step).max() < SETTLED:
                break
        yield at


def _singular_values(local: ScaledSystem, *jacobians: Array) -> list[NDArray[np.floating]]:
    """Singular values of matrices (n, n + 1) after the change of units of the states that balances them together.

    A state whose scale was guessed badly would otherwise make the others' Jacobian look singular.
    """
    units = _balancing_units(local, *jacobians)
    return list(np.linalg.svd(np.array(jacobians) * units / units[:-1, None], compute_uv=False))


def _balancing_units(local: ScaledSystem, *jacobians: Array) -> Array:
    """Units of the states (1 for the parameter), (n + 1,), in which rows and columns of all F_u together are alike.

    Only pairs of states that act on each other are balanced: where one of the two couplings is a rounding error, the
    ratio of the two says nothing. The product of the two does not depend on units. Equations without time have rows
    in units of their own: their order says which state acts on which, and nothing is balanced.
    """
    n = len(jacobians[0])
    if local.problem.is_timeless:
        return np.ones(n + 1)
    total = np.abs(np.array(jacobians)[:, :, :n]).max(axis=0)
    relative = total / max(float(total.max()), np.finfo(float).tiny)  # squares of long cycles' derivatives overflow
    products = relative * relative.T
    units = np.ones(n + 1)
    units[:n] = balancing_scales(np.where(products >= MUTUAL * products.max(), total, 0.0))
    return units


def _singular_throughout(local: ScaledSystem, y: Array, tangent: Array, corank: int) -> bool:
    """True where the Jacobian loses as much rank beside the point, on the curve, as at it."""
    jacobians = [local.linearise(y)[1]]
    for at in _beside(local, y, tangent):
        jacobians.append(np.full_like(jacobians[0], np.nan) if at is None else local.linearise(at)[1])
        if not np.isfinite(jacobians).all():
            return False  # the equations have no value there, so nothing is a point of the branch
        at_point, *around = _singular_values(local, *jacobians)
        for singular in around:
            if singular[-corank] > max(100.0 * at_point[-corank], ROUNDED * singular[0]):
                return False
    return True


def _critical_throughout(
    problem: AlgebraicEquations, local: ScaledSystem, y: Array, pair: complex, tangent: Array, count: int
) -> bool:
    """True where `count` pairs stay on the stability boundary along the branch: centres of a conservative system."""
    for at in _beside(local, y, tangent):
        if at is None:
            return False
        values, rates = spectrum(problem.linear_part(at * local.scale))
        chosen = np.argsort(np.abs(values - pair))[:count]
        distance = np.abs(np.abs(values) - 1.0) if problem.is_map else np.abs(values.real)
        if np.any(distance[chosen] > CENTRE * noises(values, rates)[chosen]):
            return False
    return True


def _branch_point(
    problem: AlgebraicEquations, local: ScaledSystem, y: Array, frame: Frame, corank: int, tangent: Array
) -> Outcome:
    solved = defining.branch_point(local, y, corank)
    if solved is not None and not solved.residual <= CONSISTENT * solved.noise:  # with borders of its own
        solved = defining.branch_point(local, solved.y, corank) or solved

    def critical(values: Vector) -> list[int]:
        target = 1.0 if problem.is_map else 0.0
        return list(np.argsort(np.abs(values - target))[:corank])

    converged = solved is not None and solved.residual <= RESIDUAL_LIMIT
    if solved is not None and converged and _singular_throughout(local, solved.y, tangent, corank):
        return Rejected(
            "the Jacobian is singular along the branch (a continuous symmetry or a conserved quantity): no branch point"
        )
    accepted = _accept(problem, "BP", frame, solved, critical)
    if isinstance(accepted, Verified) and solved is not None:
        vectors = {"kernel": corank}
        if corank == 1 and _turns_on_all(local, solved.y, tangent):
            vectors["turning"] = 2
        return _with(accepted, vectors=vectors)
    return accepted


def _turns_on_all(local: ScaledSystem, y: Array, tangent: Array) -> bool:
    """True where F_u alone has a kernel of dimension two: as the parameter's slope is not in its range, the parameter
    turns on all branches there (a fold of a complex equation, written in real and imaginary parts).
    """
    jacobians = [local.linearise(at)[1] for at in (y, y + BESIDE * tangent)]
    if local.n < 2 or not np.isfinite(jacobians).all():
        return False
    units = _balancing_units(local, *jacobians)[:-1]
    here, beside = (np.linalg.svd(j[:, :-1] * units / units[:, None], compute_uv=False) for j in jacobians)
    return bool(here[-2] < SINGULAR * max(float(here[0]), float(beside[0])))


def _real_critical(problem: AlgebraicEquations) -> Critical:
    target = 1.0 if problem.is_map else 0.0
    return lambda values: [int(np.abs(values - target).argmin())]


def _nearest(values: Vector, targets: Sequence[complex]) -> list[int]:
    chosen: list[int] = []
    for t in targets:
        order = [int(i) for i in np.argsort(np.abs(values - t)) if int(i) not in chosen]
        chosen.append(order[0])
    return chosen


def _accept(
    problem: AlgebraicEquations, type_: str, frame: Frame, solved: Solved | None, critical: Critical
) -> Outcome:
    """Turn a solution of a defining system into a point in the user's units."""
    if solved is None:
        return unverified(type_, "Newton on its defining system did not converge")
    if not solved.residual <= min(RESIDUAL_LIMIT, CONSISTENT * solved.noise):
        return unverified(type_, f"its defining system has no solution nearby (residual {solved.residual:.1e})")
    z = solved.y * frame.scale
    values, rates = spectrum(problem.linear_part(z))
    other = np.ones(len(values), bool)
    other[critical(values)] = False
    beyond = (np.abs(values) - 1.0 if problem.is_map else values.real)[other]
    sizes = 1.0 if problem.is_map else noises(values, rates)[other]
    # at a multiple branch point Newton's method for a simple one stops where the others are no more than its error
    crowded = bool((np.abs(beyond) < (CRITICAL if type_ == "BP" else SINGULAR) * sizes).any())
    width, at, epsilon = float(frame.scale[-1]), abs(float(z[-1])), float(np.finfo(float).eps)
    if beyond.size and is_suspect(values, problem.is_map):  # of a pair that is critical together one is left
        beyond = np.where(np.abs(beyond) <= errors_of(problem, z, values, frame.scale)[other], 0.0, beyond)
    approximate = accuracy_of_equations(problem.system, grained=False)  # the defining system's values show that
    error = (solved.error + approximate * solved.sensitivity) * width + 0.5 * epsilon * at
    if at <= min(error, epsilon * width):
        z[-1] = 0.0  # and not 1e-42 or -0.0
    return Verified(type_, z, solved.residual, error, values, int((beyond > 0.0).sum()), crowded=crowded)


def eigenvalues_of(problem: AlgebraicEquations, z: Array) -> Vector:
    """Eigenvalues of f_u at z, by falling real part."""
    return spectrum(problem.linear_part(z))[0]


def verify_compound(problem: AlgebraicEquations, a: Sample, b: Sample, frame: Frame) -> list[Outcome]:
    """Everything that happens at one place: folds, branch points of any corank, several pairs."""
    frame, tangent = _balanced_frame(problem, a, frame)
    y = 0.5 * (a.z + b.z) / frame.scale
    local = ScaledSystem(problem, frame.scale).rated(y)
    found: list[Outcome] = []
    _, jacobian = local.linearise(y)
    _, beside = local.linearise(y + BESIDE * tangent)
    if not (np.all(np.isfinite(jacobian)) and np.all(np.isfinite(beside))):
        return [Rejected("the equations are not finite here")]
    here, there = _singular_values(local, jacobian, beside)
    size = max(float(here[0]), float(there[0]), 1e-300)
    slopes = there / BESIDE  # a singular value counts that may vanish between a and b
    width = float(np.linalg.norm((b.z - a.z) / frame.scale))
    corank = int(np.sum(here < np.maximum(SINGULAR * size, 2.0 * width * slopes)))
    at_most = int(np.sum(here < CRITICAL * size))  # beside a multiple zero signs of tests are rounding
    multiple = _multiple(problem, local, y, frame, at_most, tangent) if at_most > max(corank, 1) else None
    if multiple is not None:
        found.append(multiple)
    elif corank >= 1:
        found.append(_branch_point(problem, local, y, frame, corank, tangent))
    elif opposite(a.tests[0], b.tests[0]):
        found.append(_fold(problem, local, y, frame))
    flips = int(np.sum(np.abs(eigenvalues_of(problem, y * frame.scale) + 1.0) < CRITICAL)) if problem.is_map else 0
    together = _flip(problem, local, y, frame, flips) if flips > 1 else NOTHING
    if isinstance(together, Verified):
        found.append(together)
    elif opposite(a.tests[3], b.tests[3]):
        found.append(_flip(problem, local, y, frame, 1))
    for pair, count in _pairs_on_boundary(*spectrum(problem.linear_part(y * frame.scale)), problem.is_map):
        found.append(_crossing_pair(problem, local, y, frame, pair, tangent, count))
    return with_hopf_points_told(found, frame.scale)


def _multiple(
    problem: AlgebraicEquations, local: ScaledSystem, y: Array, frame: Frame, corank: int, tangent: Array
) -> Verified | None:
    """A branch point at which this many eigenvalues vanish together, as near to y as they are to zero there."""
    found = _branch_point(problem, local, y, frame, corank, tangent)
    near = isinstance(found, Verified) and float(np.linalg.norm(found.z / frame.scale - y)) < NEXT
    return found if isinstance(found, Verified) and near else None


def _pairs_on_boundary(values: Vector, rates: Array, is_map: bool) -> list[tuple[complex, int]]:
    """Complex pairs on the stability boundary (one of each, Im > 0), with how many share the same value."""
    groups: list[tuple[complex, int]] = []
    for value, rate in zip(values, noises(values, rates), strict=True):
        size = 1.0 if is_map else float(rate)
        distance = abs(abs(value) - 1.0) if is_map else abs(value.real)
        if value.imag <= CRITICAL * size or distance >= CRITICAL * size:
            continue
        for k, (known, count) in enumerate(groups):
            if abs(known - value) < CRITICAL * size:
                groups[k] = (known, count + 1)
                break
        else:
            groups.append((complex(value), 1))
    return groups


def branch_tangents(local: ScaledSystem, y: Array) -> list[Array]:
    """Unit tangents of the branches through y: the null vector of J.

    Or at a branch point those of the reduced equation.
    """
    units = _balancing_units(local, local.linearise(y)[1])
    balanced = replace(local, scale=local.scale * units)
    balanced = balanced.rated(y / units)
    tangents = [units * t for t in _tangents(balanced, y / units)]
    return [t / np.linalg.norm(t) for t in tangents]


def _tangents(local: ScaledSystem, y: Array) -> list[Array]:
    """The same in balanced units."""
    _, jacobian = local.linearise(y)
    left, singular, right = np.linalg.svd(jacobian)
    size = max(float(singular[0]), 1e-300)
    if singular[-1] > 1e-6 * size and local.n > 1:
        return [right[-1]]
    # all of J may vanish at the point: its size is also what it grows to over one unit of length
    bends = [local.hessian(y, v) for v in right[-2:]]
    size = max(size, *(float(np.linalg.norm(bend)) for bend in bends))
    corank = int(np.sum(singular <= 1e-9 * size))
    if corank == 0:
        return [right[-1]]
    if corank == 1:
        return _crossing(left[:, -1], right[-2:], bends) or [right[-1]]

    turning = turning_kernel(local.problem, y * local.scale, local.scale[:-1], corank)
    if turning is not None:  # the branch at hand is that of the states that the rotation keeps
        own = right[-corank - 1 :].copy()
        own[:, :-1] -= own[:, :-1] @ turning.basis @ turning.basis.T
        longest = own[int(np.argmax(np.linalg.norm(own, axis=1)))]
        return [longest / np.linalg.norm(longest)]
    try:
        return [o.direction for o in reduced_branches(local, y, np.zeros(local.n + 1), corank)] or [right[-1]]
    except np.linalg.LinAlgError:  # the zero eigenvalue is defective: the reduction has no basis
        return [right[-1]]


def crossing_tangents(local: ScaledSystem, y: Array) -> list[Array]:
    """Tangents of the two branches that cross at a simple branch point.

    With N (n + 1, 2) spanning ker J and psi the left null vector, tangents N (a, b) solve the algebraic branching
    equation sum_ij psi . D^2F[N_i, N_j] a_i a_j = 0 (Keller 1977). Empty where it has no two real solutions.
    """
    left, kernel = defining.singular_basis(local.linearise(y)[1], 1)
    return _crossing(left[:, 0], kernel.T, [local.hessian(y, v) for v in kernel.T])


def _crossing(left: Array, kernel: Array, bends: Sequence[Array]) -> list[Array]:
    """The same, given psi, N^T and the matrices D^2F[N_i, .]."""
    c = np.array([bend.T @ left for bend in bends]) @ kernel.T
    angles, sizes = np.linalg.eigh(c)
    # c = Q diag(l1, l2) Q^T: a^T c a = 0 along sqrt(-l2 / l1)
    if angles[0] * angles[1] >= 0.0:
        return []
    ratio = np.sqrt(-angles[0] / angles[1])
    tangents = []
    for sign in (1.0, -1.0):
        a = sizes[:, 0] + sign * ratio * sizes[:, 1]
        t = a @ kernel
        tangents.append(t / np.linalg.norm(t))
    return tangents
