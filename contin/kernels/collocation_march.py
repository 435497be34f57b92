"""Pseudo-arclength march along a family of periodic orbits in one kernel call; the model is a pointer.

The matrix is factorised once a step, at the predicted point; the corrector repeats only the cheap part (chord
iterations) and factorises again where that converges slowly. Tangent, test functions and multipliers come from the same
factors. Layout of z and equations: `contin.kernels.collocation`; test functions (columns of `tests`):

    0  dp/ds                        zero at folds of cycles
    1  sign det M / |y|             zero at branch points; M y = (a fixed jump of u over a period), y = (u(0), T, p)
    2  pairs, 3  flips              of the nontrivial multipliers, see `tests_of_stability`

Memory comes from Python (`new_scratch` and the like) and slices of arrays are avoided: numba compiles each of them as a
function of its own, and that was two thirds of the time of the first compilation.
"""

import math
from collections import namedtuple

import numpy as np

from contin.kernels.algebraic import TESTS
from contin.kernels.chords import (
    AFRESH,
    CONVERGED,
    EXACT,
    FAILED,
    ITERATIONS,
    STALE,
    allowed,
    follows,
    is_stale,
    kept,
)
from contin.kernels.collocation import evaluate, new_points, residual, set_phase
from contin.kernels.collocation_mesh import mesh_error
from contin.kernels.collocation_steps import advance, along, direct, distance, predict, product
from contin.kernels.collocation_system import factorise, new_factors, solve, solve_start
from contin.kernels.compile import call3, kernel
from contin.kernels.condensation import eliminate_intervals
from contin.kernels.filling import fill
from contin.kernels.floquet import deflate, multipliers, transitions
from contin.kernels.signature import structure
from contin.kernels.stages import weigh
from contin.kernels.steering import (
    ACCEPTED,
    AT_CORNER,
    BOUND,
    CLOSE,
    CORNER,
    CORRECTOR,
    DIP,
    LIMIT,
    LOOP,
    NOT_FINITE,
    RESCALE,
    STRAYED,
    judged,
    leaves,
    met,
    next_step,
    recall,
    record,
    shortened,
)
from contin.kernels.tests_of_stability import map_tests

MARCH, PROBE, STABILITY, CORRECT = range(4)  # what `follow` does

WANTED = 1.5e-3  # first correction, as a part of the orbit's size, that the step control aims at
OUTGROWN = 2.0  # sizes beyond which a state has another one
MISSED = 1e-5  # the trivial multiplier, beyond which the others have less than the digits that are read
MOVED_FREELY = 1e-6  # ... and the distance in which multipliers of forced systems change by as much
SHRINKING = 3.0  # an orbit is looked at as it shrinks when its amplitude falls below this many steps

Scratch = namedtuple(
    "Scratch",
    [
        "z",
        "step",
        "old",  # the tangent before the last one
        "before",  # the point before the last one
        "tests",
        "sizes",  # of a correction, see `contin.kernels.chords`
        "density",
        "transitions",  # (N, n, n)
        "field",  # (N, n) f at the mesh points
        "basis",  # (d, d) of the multipliers' iteration, d nontrivial ones; NaN where unknown
        "re",  # (d,)
        "im",
        "jump",  # (n,)
        "right",  # (2,)
        "border",  # (2, 2)
        "state",  # (n,)
        "every",  # (size,) ones: all of z counts where a loop closes (of boundary-value problems)
        "none",  # (0,) ... and none of it is an angle
    ],
)
structure(Scratch, "f1, f1, f1, f1, f1, f1, f1, f3, f2, f2, f1, f1, f1, f1, f2, f1, f1, f1")


def new_scratch(n, nontrivial, intervals, size):
    """Memory for `follow`."""
    return Scratch(
        np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(TESTS), np.zeros(4),
        np.zeros(intervals), np.zeros((intervals, n, n)), np.zeros((intervals, n)),
        np.full((nontrivial, nontrivial), np.nan), np.zeros(nontrivial), np.zeros(nontrivial), np.zeros(n),
        np.zeros(2), np.zeros((2, 2)), np.zeros(n), np.ones(size), np.zeros(0),
    )  # fmt: skip


def new_memory(n, m, nontrivial, intervals, size, p):
    """(points, factors, scratch) for one mesh."""
    return new_points(n, m, intervals, p), new_factors(n, m, intervals), new_scratch(n, nontrivial, intervals, size)


@kernel("Equations, Points, Factors, Scratch, f1, f1, f1, f, f -> i")
def correct(e, w, s, x, z0, tangent, scale, reach, tolerance):
    """Newton with chord iterations on the plane <tangent, (z - z0) / scale> = reach, on x.z (phase row set).

    Returns the sign of the determinant (+1, -1), 0 (no convergence) or 2 (not finite); `s` holds the last factors.
    """
    n, m = e.n, e.m
    z, step, sizes, jump, right, border = x.z, x.step, x.sizes, x.jump, x.right, x.border
    nodes = z.size - 2 - x.density.size
    sign = 0
    fresh = True
    before = math.inf
    for j in range(4):
        sizes[j] = 0.0
    for iteration in range(ITERATIONS):
        sizes[1] += 1.0
        if not evaluate(e, w, z, fresh):
            return 2
        residual(e, w, z, s.right_local, jump, right)
        right[1] = reach - along(tangent, z, z0, scale)
        if fresh:
            sizes[3] += 1.0
            sizes[2] = 0.0
            sign = fill(e, w, z, tangent, scale, s, border)
            if sign != 0:
                sign *= factorise(s, n, m, border, 1.0)
            if sign == 0:
                return 0
        solve(s, n, m, jump, right, 1.0, True, step)
        size = advance(z, step, scale, nodes)
        following = follows(iteration, size, before, fresh, z[nodes] > 0.0, tolerance, sizes)
        if following == CONVERGED:
            return sign
        if following == FAILED:
            return 0
        fresh = following == AFRESH
        before = size
    return 0


@kernel("Equations, Points, Factors, Scratch, f1, f1 -> i")
def renew(e, w, s, x, tangent, scale):
    """Factors at x.z itself; returns the sign of the determinant."""
    if not evaluate(e, w, x.z, True):
        return 0
    sign = fill(e, w, x.z, tangent, scale, s, x.border)
    return sign * factorise(s, e.n, e.m, x.border, 1.0) if sign != 0 else 0


@kernel("Equations, Points, Factors, Scratch, f2, i, f1, f1, f -> i")
def settled(e, w, s, x, here, sign, scale, sizes, tolerance):
    """Row 0 of `here` becomes the corrected point x.z where it was not on the family to `tolerance`: after a change of
    mesh it is not.

    sign : what `correct` has said. Returns it; 0 where the factors in `s` are not those of that point. x.z is put back
    where the point stays as it is although it is not on the family.
    """
    z, size = x.z, scale.size
    nodes = size - 2 - x.density.size
    stays = kept(z, here, sign, distance(z, here[0], scale), tolerance)
    set_phase(e, w, z, sizes)
    return 0 if stays or x.sizes[2] > STALE * min(1.0, extent(z, e.n, nodes // e.n, sizes, e.periods)[0]) else sign


@kernel("Equations, Points, Factors, Scratch -> f")
def floquet(e, w, s, x):
    """Multipliers from the condensed blocks in `s`: nontrivial ones into x.re, x.im.

    Returns the trivial one (NaN: failed).
    """
    n, m = e.n, e.m
    z, m_all, field, state = x.z, x.transitions, x.field, x.state
    F, p = w.F, w.p
    fine = True
    transitions(s.local, n, m, s.stages.weights, m_all)
    trivial = 1.0
    skip = 0
    if e.forcing == 0:
        skip = 1
        p[e.active] = z[z.size - 1]
        for i in range(field.shape[0]):
            for k in range(n):
                state[k] = z[i * m * n + k]
            call3(e.value, state, p, F)
            for k in range(n):
                field[i, k] = F[k] * s.stages.weights[k]
        trivial = deflate(m_all, field)
        fine &= math.isfinite(trivial)
    if fine and multipliers(m_all, skip, x.basis, x.re, x.im):
        return trivial
    return math.nan


@kernel("Equations, Points, Factors, Scratch, f1, f1, i, f, i, i, f2, f1, f2, f2 -> i")
def measure(e, w, s, x, scale, sizes, sign, reference, near, row, out_t, tests, out_re, out_im):
    """Tangent (row of out_t), test functions (x.tests) and multipliers (row of out_re, out_im) at x.z, from the
    factors.

    `near` is the row with the multipliers of a neighbour, or -1. Returns the number of unstable ones.
    """
    n, m = e.n, e.m
    z, step, jump, right = x.z, x.step, x.jump, x.right
    nodes = z.size - 2 - x.density.size
    for k in range(n):
        jump[k] = 0.0
    right[0] = 0.0
    right[1] = 1.0
    solve(s, n, m, jump, right, 1.0, False, step)
    direct(step, scale, nodes, out_t[row])
    tests[0] = out_t[row, z.size - 1]
    for k in range(n):
        jump[k] = sizes[k] * math.cos(1.0 + k)
    right[1] = 0.0
    solve_start(s, n, jump, right)
    start = s.right_last
    square = (start[n] / scale[nodes]) ** 2 + (start[n + 1] / scale[scale.size - 1]) ** 2
    for k in range(n):
        square += (start[k] / sizes[k]) ** 2 / n
    exponent = -0.5 * math.log(square) - reference
    tests[1] = sign * math.exp(min(max(exponent, -700.0), 700.0))
    d = x.re.size
    for k in range(d):
        x.re[k] = out_re[near, k + n - d] if near >= 0 else math.nan
        x.im[k] = out_im[near, k + n - d] if near >= 0 else math.nan
    trivial = floquet(e, w, s, x)
    out_re[row, 0] = trivial
    out_im[row, 0] = 0.0
    failed = not math.isfinite(trivial)
    for k in range(d):
        out_re[row, k + n - d] = math.nan if failed else x.re[k]
        out_im[row, k + n - d] = 0.0 if failed else x.im[k]
    if failed:
        tests[2] = math.nan
        tests[3] = math.nan
        return 0
    return map_tests(x.re, x.im, tests)


@kernel("f1, i, i, f1, f1 -> (f, f)")
def extent(z, n, count, sizes, periods):
    """Largest max - min, and largest modulus but of angles, of a state over the orbit, relative to its size.

    An angle's size is that of its period, however many turns an orbit makes.
    """
    swing = 0.0
    largest = 0.0
    for k in range(n):
        low = z[k]
        high = z[k]
        for i in range(count):
            low = min(low, z[i * n + k])
            high = max(high, z[i * n + k])
        swing = max(swing, (high - low) / sizes[k])
        if periods[k] == 0.0:
            largest = max(largest, max(high, -low) / sizes[k])
    return swing, largest


@kernel("f, f, f, i -> b")
def is_off(trivial, missed, moved, forcing):
    """True where multipliers from factors of a point nearby are to be computed again, from those of the orbit itself.

    trivial : the multiplier that is 1, which says how far they are off; of forced systems, which have none, the point
        has `moved` since.  missed : by how much the mesh makes it miss 1.
    """
    if forcing != 0:
        return moved > MOVED_FREELY
    return not abs(trivial - 1.0) <= max(MISSED, 3.0 * missed)


@kernel("f1, f1, f1, f1, f1, f -> b")
def back_at_start(z, before, start, tangent, scale, h):
    """True where the family passes its start, a point of this mesh, between `before` and `z`, in its sense."""
    if not (along(tangent, before, start, scale) < 0.0 and along(tangent, z, start, scale) >= 0.0):
        return False
    return distance(z, start, scale) <= CLOSE * h


@kernel(
    "i, Equations, Points, Factors, Scratch, f1, f1, f1, f1, i, f1, f, f1, f1, f1, f1, f1, f2, f2, f2, i1, f2, f2, "
    "f1, f1, f1 -> i"
)
def follow(
    mode, e, w, s, x, scale, sizes, bounds, controls, limit, top, error_constant, previous_z, previous_tangent,
    previous_tests, loop_z, loop_tangent, out_z, out_t, out_tests, out_unstable, out_re, out_im, out_h, out_error, info,
):  # fmt: skip
    """What `mode` says. One kernel for all: each kernel that calls others compiles them once more.

    MARCH : follow the family from row 0 of out_z (guide tangent out_t[0], scaled) for up to `limit` accepted orbits.
        Returns the reason, as `contin.kernels.algebraic.march`; RESCALE also where the mesh no longer resolves the
        orbit, the period has reached its limit, or the orbit is about to shrink to a point.
    PROBE : solve on the plane <out_t[0], (z - out_z[0]) / scale> = controls[0] from the guess in row 1 of out_z and
        measure there (row 1); info[3] is the reference of test 1. Returns the unstable count, -1 or -2 (not finite).
    CORRECT : solve as for PROBE, and nothing else. Returns 0, -1 or -2.
    STABILITY : multipliers of row 0, whatever the rank of the boundary-value problem. Returns 1 (done) or 0.

    e : `Equations`; w, s, x : `new_memory`.
    controls : [h, h_min, h_max, cos_max_angle, tolerance, h_previous, target_angle, error_limit, period_limit,
        worthwhile]
        h_previous = 0 where `previous_*` (z, tangent, tests relative to row 0) are unknown.
    worthwhile : of a fixed number of intervals: part of the error that a better mesh must leave at most; else 0.
    info : [rows beyond row 0, next h, evaluations, log reference of test 1, test that dipped, h that failed]
    """
    n, m = e.n, e.m
    size = scale.size
    last = size - 1
    z, old, tests, sizes_of, density = x.z, x.old, x.tests, x.sizes, x.density
    intervals = density.size
    count = intervals * m + 1
    h, h_min, h_max, cos_max, tolerance = controls[0], controls[1], controls[2], controls[3], controls[4]
    h_previous, target_angle, error_limit, period_limit = controls[5], controls[6], controls[7], controls[8]
    worthwhile = controls[9]
    reference = info[3] if mode == PROBE else 0.0
    weigh(s.stages.weights, n, sizes)
    start = 1 if mode in (PROBE, CORRECT) else 0
    for j in range(size):
        z[j] = out_z[start, j]
    if mode != STABILITY:
        set_phase(e, w, z, sizes)
        sign = correct(e, w, s, x, out_z[0], out_t[0], scale, h if start == 1 else 0.0, tolerance)
        if start == 1 and (sign == 0 or sign == 2):
            return -1 if sign == 0 else -2
    if mode == CORRECT:
        for j in range(size):
            out_z[1, j] = z[j]
        return 0
    if mode == STABILITY:
        if not evaluate(e, w, z, True):
            return 0
        if fill(e, w, z, out_t[0], scale, s, x.border) == 0 or eliminate_intervals(s, n, m) == 0:
            return 0
        for k in range(x.re.size):
            x.re[k] = math.nan
        out_re[0, 0] = floquet(e, w, s, x)
        out_im[0, 0] = 0.0
        for k in range(x.re.size):
            out_re[0, k + n - x.re.size] = x.re[k]
            out_im[0, k + n - x.re.size] = x.im[k]
        return 1 if math.isfinite(out_re[0, 0]) else 0
    evaluations = 0.0
    if mode == MARCH:
        sign = settled(e, w, s, x, out_z, sign, scale, sizes, tolerance)
        evaluations = sizes_of[1]
    if sign == 0 or (mode == PROBE and sizes_of[2] > EXACT):
        sign = renew(e, w, s, x, out_t[0], scale)
        evaluations += 1.0
    if sign == 0:
        return -1 if mode == PROBE else CORRECTOR
    unstable = measure(e, w, s, x, scale, sizes, sign, reference, -1, start, out_t, tests, out_re, out_im)
    if mode == PROBE:
        record(z, tests, out_z, out_tests, 1)
        return unstable
    for i in range(6):
        info[i] = 0.0
    info[1] = h
    info[2] = evaluations
    reference = math.log(abs(tests[1]))
    tests[1] = float(sign)
    info[3] = reference
    record(z, tests, out_z, out_tests, 0)
    out_unstable[0] = unstable
    missed = abs(out_re[0, 0] - 1.0)
    out_error[0] = mesh_error(z, n, m, intervals, True, top, error_constant, sizes, density)
    swing, _ = extent(z, n, count, sizes, e.periods)
    strayed = 0
    for k in range(limit):
        row = k + 1
        tangent = out_t[k]
        recall(out_t, previous_tangent, k, old)
        recall(out_z, previous_z, k, x.before)
        if k > 0:
            h_previous = out_h[k]
            for j in range(size):
                z[j] = out_z[k, j]
            set_phase(e, w, z, sizes)
        cosine = 1.0
        while True:
            predict(out_z[k], tangent, x.before, old, scale, h, h_previous, z)
            sign = correct(e, w, s, x, out_z[k], tangent, scale, h, tolerance)
            info[2] += sizes_of[1]
            if is_stale(sign, sizes_of[2], min(1.0, swing)):
                sign = renew(e, w, s, x, tangent, scale)
                info[2] += 1.0
                sizes_of[2] = 0.0
            if sign != 0 and sign != 2 and leaves(distance(z, out_z[k], scale), h, cos_max, tolerance):
                sign = 0
            if sign == 0 or sign == 2:
                if h <= h_min:
                    info[5] = h
                    info[1] = h
                    return NOT_FINITE if sign == 2 else CORRECTOR
                h = max(0.4 * h, h_min)
                continue
            unstable = measure(e, w, s, x, scale, sizes, sign, reference, k, row, out_t, tests, out_re, out_im)
            if sizes_of[2] > EXACT and is_off(out_re[row, 0], missed, sizes_of[2], e.forcing):
                again = renew(e, w, s, x, tangent, scale)
                info[2] += 1.0
                if again != 0:
                    sign = again
                    unstable = measure(e, w, s, x, scale, sizes, sign, reference, k, row, out_t, tests, out_re, out_im)
                    missed = abs(out_re[row, 0] - 1.0)
                    sizes_of[2] = 0.0
            cosine = product(tangent, out_t[row])
            verdict = judged(
                tests, out_tests, k, previous_tests, 1, False, cosine, cos_max, h, h_min, h_previous, strayed < 3
            )
            if verdict in (ACCEPTED, AT_CORNER):
                break
            strayed += verdict == STRAYED
            h = shortened(verdict, h, h_min)
        strayed = 0
        out_h[row] = h
        out_unstable[row] = unstable
        record(z, tests, out_z, out_tests, row)
        out_error[row] = mesh_error(z, n, m, intervals, True, top, error_constant, sizes, density)
        info[0] = row
        angle = math.acos(min(cosine, 1.0)) if verdict != AT_CORNER else target_angle
        h_used = h
        wanted = WANTED * min(1.0, swing)
        h = next_step(h, angle, target_angle, sizes_of[0], wanted, 4.0, sizes_of[1], 5.0, h_min, h_max)
        info[1] = h
        if verdict == AT_CORNER:
            return CORNER
        if z[last] < bounds[0] or z[last] > bounds[1]:
            return BOUND
        changed = unstable != out_unstable[k]
        for i in range(TESTS):
            changed |= tests[i] * out_tests[k, i] <= 0.0
        what = met(tests, out_tests, k, previous_tests, 0, changed, h_previous, h_used, info)
        if what == DIP and sizes_of[2] > EXACT:  # factors of a point nearby may bend a test that is small
            sign = renew(e, w, s, x, tangent, scale)
            info[2] += 1.0
            if sign != 0:
                unstable = measure(e, w, s, x, scale, sizes, sign, reference, k, row, out_t, tests, out_re, out_im)
                out_unstable[row] = unstable
                record(z, tests, out_z, out_tests, row)
                changed = unstable != out_unstable[k]
                for i in range(TESTS):
                    changed |= tests[i] * out_tests[k, i] <= 0.0
                what = met(tests, out_tests, k, previous_tests, 0, changed, h_previous, h_used, info)
        if what != LIMIT:
            return what
        if loop_z.size == size and back_at_start(z, out_z[k], loop_z, loop_tangent, scale, h_used):
            return LOOP
        before = swing
        swing, largest = extent(z, n, count, sizes, e.periods)
        if swing < before and swing < SHRINKING * max(h, h_used):
            return RESCALE
        if largest > OUTGROWN or z[count * n] > period_limit:
            return RESCALE
        error_limit = allowed(z, n, m, error_constant, density, out_error[row], error_limit, worthwhile)
        if error_limit == 0.0:
            return RESCALE
    return LIMIT
