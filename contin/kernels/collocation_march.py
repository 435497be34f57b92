"""Pseudo-arclength march along a family of periodic orbits in one kernel call; the model is a pointer.

The matrix is factorised once a step, at the predicted point; the corrector repeats only the cheap part (chord
iterations) and factorises again where that converges slowly. Tangent, test functions and multipliers come from the same
factors. Layout of z and equations: `contin.kernels.collocation`; test functions (columns of `tests`):

    0  dp/ds                        zero at folds of cycles
    1  sign det M / |y|             zero at branch points; M y = (a fixed jump of u over a period)
    2  pairs, 3  flips              of the nontrivial multipliers, see `tests_of_stability`
"""

import math

import numpy as np

from contin.kernels.algebraic import (
    BOUND, CORNER, CORRECTOR, DIP, EVENT, GROWTH, GUARD, GUARD_FLOOR, LIMIT, LOOP, NOT_FINITE, RESCALE, STAGNATION, TESTS,
    is_dip,
)  # fmt: skip
from contin.kernels.collocation import evaluate, fill, new_points, residual, set_phase
from contin.kernels.collocation_elimination import eliminate
from contin.kernels.collocation_mesh import mesh_error
from contin.kernels.collocation_system import factorise, new_factors, solve
from contin.kernels.compile import call3, kernel
from contin.kernels.floquet import deflate, multipliers, transitions
from contin.kernels.tests_of_stability import map_tests

ITERATIONS = 14
FACTORISATIONS = 6
SLOW = 0.15  # a chord iteration that contracts less than this is followed by a new factorisation
STALE = 2e-3  # factors are renewed before measuring when the point has moved further than this since
WANTED = 4e-3  # first correction that the step control aims at
SHRINKING = 3.0  # an orbit is looked at as it shrinks when its amplitude falls below this many steps


@kernel
def correct(e, w, s, z, z0, tangent, scale, length, tolerance, step, sizes):
    """Newton with chord iterations on the plane <tangent, (z - z0) / scale> = length (z in place, phase row set).

    Returns the sign of the determinant (+1, -1), 0 (no convergence) or 2 (not finite); `s` holds the last factors.
    sizes : [first correction, evaluations, distance moved since the last factorisation, factorisations].
    """
    n, m = e.n, e.m
    intervals = w.u.shape[2]
    nodes = (intervals * m + 1) * n
    jump = np.empty(n)
    right = np.empty(2)
    border = np.zeros((2, 2))
    last = z.size - 1
    sign = 0
    fresh = True
    before = math.inf
    sizes[:] = 0.0
    for iteration in range(ITERATIONS):
        sizes[1] += 1.0
        if not evaluate(e, w, z, fresh):
            return 2
        residual(e, w, z, s.right_local, jump, right)
        along = tangent[last] * (z[last] - z0[last]) / scale[last]
        for j in range(nodes + 1):
            along += tangent[j] * (z[j] - z0[j]) / scale[j]
        right[1] = length - along
        if fresh:
            sizes[3] += 1.0
            sizes[2] = 0.0
            fill(e, w, z, tangent, scale, s.local, border)
            sign = factorise(s, n, m, border, 1.0)
            if sign == 0:
                return 0
        solve(s, n, m, jump, right, 1.0, True, step)
        size = 0.0
        for j in range(nodes + 1):
            d = step[j] / scale[j]
            size += d * d
            z[j] += step[j]
        d = step[nodes + 1] / scale[last]
        size = math.sqrt(size + d * d)
        z[last] += step[nodes + 1]
        sizes[2] += size
        if iteration == 0:
            sizes[0] = size
        if size <= tolerance:
            return sign
        if not size < 1e3 or not z[nodes] > 0.0:
            return 0
        ratio = size / before
        if iteration > 0:
            if ratio < 0.5 and size * ratio < 0.1 * tolerance:
                return sign
            if ratio > 0.5 and size < STAGNATION and size < sizes[0]:
                return sign
            if fresh and ratio > 0.8:
                return 0
            if sizes[3] >= FACTORISATIONS:
                return 0
        fresh = iteration > 0 and ratio > SLOW
        if iteration == 0 and size > 0.1:
            fresh = True
        before = size
    return 0


@kernel
def measure(e, w, s, z, tangent, scale, sizes, sign, reference, m_all, basis_q, tangent_out, tests, re, im, step):
    """Unit tangent, test functions and multipliers from the factors in `s` (at z, or near it); returns the unstable count.

    re, im : multipliers (n,), on entry those of a neighbour or NaN; autonomous systems have the trivial one first.
    """
    n, m = e.n, e.m
    intervals = w.u.shape[2]
    nodes = (intervals * m + 1) * n
    last = z.size - 1
    jump = np.zeros(n)
    right = np.zeros(2)
    right[1] = 1.0
    solve(s, n, m, jump, right, 1.0, False, step)
    norm = 0.0
    for j in range(nodes + 1):
        tangent_out[j] = step[j] / scale[j]
        norm += tangent_out[j] * tangent_out[j]
    tangent_out[last] = step[nodes + 1] / scale[last]
    norm = math.sqrt(norm + tangent_out[last] * tangent_out[last])
    for j in range(nodes + 1):
        tangent_out[j] /= norm
    for j in range(nodes + 1, last):
        tangent_out[j] = 0.0
    tangent_out[last] /= norm
    tests[0] = tangent_out[last]
    for k in range(n):
        jump[k] = sizes[k] * math.cos(1.0 + k)
    right[1] = 0.0
    solve(s, n, m, jump, right, 1.0, False, step)
    size = (step[nodes + 1] / scale[last]) ** 2
    for j in range(nodes + 1):
        d = step[j] / scale[j]
        size += d * d
    exponent = -0.5 * math.log(size) - reference
    tests[1] = sign * math.exp(min(max(exponent, -700.0), 700.0))
    skip = 0
    fine = transitions(s.local, n, m, m_all)
    if e.forcing == 0:
        skip = 1
        field = np.empty((intervals, n))
        here = np.empty(n)
        w.p[e.active] = z[last]
        for i in range(intervals):
            for k in range(n):
                here[k] = z[i * m * n + k]
            call3(e.value, here, w.p, w.F)
            for k in range(n):
                field[i, k] = w.F[k]
        re[0] = deflate(m_all, field)
        im[0] = 0.0
        fine &= math.isfinite(re[0])
    if not (fine and multipliers(m_all, skip, basis_q, re, im)):
        re[skip:] = math.nan
        im[skip:] = 0.0
        tests[2] = math.nan
        tests[3] = math.nan
        return 0
    return map_tests(re[skip:], im[skip:], tests)


@kernel
def probe(
    e, z0, tangent, length, guess, p, scale, sizes, tolerance, reference, z, tangent_out, tests, re, im, basis_q
):
    """Solve on the plane <tangent, (z - z0) / scale> = length from `guess` and measure there; unstable count, -1 or -2 (not finite)."""
    n, m = e.n, e.m
    intervals = (z.size - n - 2) // (m * n + 1)
    w = new_points(n, m, intervals, p)
    s = new_factors(n, m, intervals)
    step = np.empty(z.size)
    info = np.zeros(4)
    z[:] = guess
    set_phase(e, w, guess, sizes)
    sign = correct(e, w, s, z, z0, tangent, scale, length, tolerance, step, info)
    if sign == 0:
        return -1
    if sign == 2:
        return -2
    sign = _renew(e, w, s, z, tangent, scale)
    if sign == 0:
        return -1
    re[:] = math.nan
    m_all = np.empty((intervals, n, n))
    return measure(
        e, w, s, z, tangent, scale, sizes, sign, reference, m_all, basis_q, tangent_out, tests, re, im, step
    )


@kernel
def _renew(e, w, s, z, tangent, scale):
    """Factors at z itself."""
    border = np.zeros((2, 2))
    if not evaluate(e, w, z, True):
        return 0
    fill(e, w, z, tangent, scale, s.local, border)
    return factorise(s, e.n, e.m, border, 1.0)


@kernel
def amplitude(z, n, count, sizes):
    """Largest max - min of a state over the orbit, relative to its size."""
    largest = 0.0
    for k in range(n):
        low = z[k]
        high = z[k]
        for i in range(count):
            low = min(low, z[i * n + k])
            high = max(high, z[i * n + k])
        largest = max(largest, (high - low) / sizes[k])
    return largest


@kernel
def outgrown(z, n, count, sizes, period_limit):
    """True where a state has become larger than twice its size, or the period has reached its limit."""
    if z[count * n] > period_limit:
        return True
    for k in range(n):
        for i in range(count):
            if abs(z[i * n + k]) > 2.0 * sizes[k]:
                return True
    return False


@kernel
def march(
    e, p, scale, sizes, bounds, controls, limit, top, error_constant, previous_tangent, previous_tests, loop_z,
    loop_tangent, out_z, out_t, out_tests, out_unstable, out_re, out_im, out_h, out_error, basis_q, info,
):  # fmt: skip
    """Follow the family from row 0 of out_z (guide tangent out_t[0], scaled) for up to `limit` accepted orbits.

    controls : [h, h_min, h_max, cos_max_angle, tolerance, h_previous, target_angle, error_limit, period_limit]
        h_previous = 0 where `previous_tangent` and `previous_tests` (tests relative to row 0) are unknown.
    info : [rows beyond row 0, next h, evaluations, log reference of test 1, test that dipped, h that failed]
    Returns the reason, as `contin.kernels.algebraic.march`; RESCALE also where the mesh no longer resolves the orbit or
    the orbit is about to shrink to a point.
    """
    n, m = e.n, e.m
    size = scale.size
    last = size - 1
    intervals = (size - n - 2) // (m * n + 1)
    count = intervals * m + 1
    nodes = count * n
    w = new_points(n, m, intervals, p)
    s = new_factors(n, m, intervals)
    h, h_min, h_max, cos_max, tolerance = controls[0], controls[1], controls[2], controls[3], controls[4]
    h_previous, target_angle, error_limit = controls[5], controls[6], controls[7]
    z = out_z[0].copy()
    step = np.empty(size)
    old = np.empty(size)
    tests = np.empty(TESTS)
    sizes_of = np.zeros(4)
    density = np.empty(intervals)
    m_all = np.empty((intervals, n, n))
    info[:] = 0.0
    info[1] = h
    set_phase(e, w, z, sizes)
    info[2] += 1
    guide = out_t[0].copy()
    if not evaluate(e, w, z, True):
        return NOT_FINITE
    border = np.zeros((2, 2))
    fill(e, w, z, guide, scale, s.local, border)
    sign = factorise(s, n, m, border, 1.0)
    if sign == 0:
        return CORRECTOR
    out_re[0] = math.nan
    unstable = measure(
        e, w, s, z, guide, scale, sizes, sign, 0.0, m_all, basis_q, out_t[0], tests, out_re[0], out_im[0], step
    )
    reference = math.log(abs(tests[1]))
    tests[1] = float(sign)
    info[3] = reference
    for i in range(TESTS):
        out_tests[0, i] = tests[i]
    out_unstable[0] = unstable
    out_error[0] = mesh_error(z, n, m, intervals, top, error_constant, sizes, density)
    swing = amplitude(z, n, count, sizes)
    guard_blocks = 0
    for k in range(limit):
        row = k + 1
        tangent = out_t[k]
        if k > 0:
            old[:] = out_t[k - 1]
            h_previous = out_h[k]
        else:
            old[:] = previous_tangent
        if k > 0:
            set_phase(e, w, out_z[k], sizes)
        corner = False
        cosine = 1.0
        while True:
            bend = 0.5 * h * h / h_previous if h_previous > 0.0 else 0.0
            for j in range(size):
                z[j] = out_z[k, j] + scale[j] * (h * tangent[j] + bend * (tangent[j] - old[j]))
            for j in range(nodes + 1, last):
                z[j] = out_z[k, j]
            sign = correct(e, w, s, z, out_z[k], tangent, scale, h, tolerance, step, sizes_of)
            info[2] += sizes_of[1]
            if sign != 0 and sign != 2 and sizes_of[2] > STALE:
                sign = _renew(e, w, s, z, tangent, scale)
                info[2] += 1
            if sign == 0 or sign == 2:
                if h <= h_min:
                    info[5] = h
                    info[1] = h
                    return NOT_FINITE if sign == 2 else CORRECTOR
                h = max(0.4 * h, h_min)
                continue
            for j in range(n):
                out_re[row, j] = out_re[k, j]
                out_im[row, j] = out_im[k, j]
            unstable = measure(
                e, w, s, z, tangent, scale, sizes, sign, reference, m_all, basis_q, out_t[row], tests, out_re[row],
                out_im[row], step,
            )  # fmt: skip
            cosine = 0.0
            for j in range(size):
                cosine += tangent[j] * out_t[row, j]
            if not cosine >= cos_max:
                if h <= max(h_min, 1e-7):
                    corner = True
                    break
                h = max(0.5 * h, h_min, 1e-7)
                continue
            if h > GUARD_FLOOR and h_previous > 0.0 and guard_blocks < 3:
                rough = False
                for i in range(1, TESTS):
                    a = out_tests[k - 1, i] if k > 0 else previous_tests[i]
                    b = out_tests[k, i]
                    expected = b + (b - a) * h / h_previous
                    if abs(tests[i] - expected) > GUARD * max(abs(a), abs(b), abs(tests[i])):
                        rough = True
                if rough:
                    guard_blocks += 1
                    h = max(0.5 * h, 0.5 * GUARD_FLOOR)
                    continue
            break
        guard_blocks = 0
        out_h[row] = h
        out_unstable[row] = unstable
        out_z[row, :] = z
        for i in range(TESTS):
            out_tests[row, i] = tests[i]
        out_error[row] = mesh_error(z, n, m, intervals, top, error_constant, sizes, density)
        info[0] = row
        angle = math.acos(min(cosine, 1.0)) if not corner else target_angle
        factor = GROWTH
        if angle > 0.0:
            factor = min(factor, target_angle / angle)
        if sizes_of[0] > 0.0:
            factor = min(factor, (WANTED / sizes_of[0]) ** (1.0 / 3.0))
        if sizes_of[1] > 5.0:
            factor = min(factor, 5.0 / sizes_of[1])
        h_used = h
        h = min(max(h * max(factor, 0.3), h_min), h_max)
        info[1] = h
        if corner:
            return CORNER
        if z[last] < bounds[0] or z[last] > bounds[1]:
            return BOUND
        changed = unstable != out_unstable[k]
        for i in range(TESTS):
            changed |= tests[i] * out_tests[k, i] <= 0.0
        if changed:
            return EVENT
        if h_previous > 0.0:
            for i in range(TESTS):
                a = out_tests[k - 1, i] if k > 0 else previous_tests[i]
                if is_dip(a, out_tests[k, i], tests[i], h_previous, h_used):
                    info[4] = i
                    return DIP
        if loop_z.size == size and _passes(z, out_z[k], loop_z, loop_tangent, scale, h_used):
            return LOOP
        before = swing
        swing = amplitude(z, n, count, sizes)
        if swing < before and swing < SHRINKING * max(h, h_used):
            return RESCALE
        if out_error[row] > error_limit or outgrown(z, n, count, sizes, controls[8]):
            return RESCALE
    return LIMIT


@kernel
def _passes(z, before, loop_z, loop_tangent, scale, h):
    """True where the step from `before` to z passes the start of the branch closely."""
    here = 0.0
    earlier = 0.0
    distance = 0.0
    for j in range(z.size):
        d = (z[j] - loop_z[j]) / scale[j]
        here += loop_tangent[j] * d
        earlier += loop_tangent[j] * (before[j] - loop_z[j]) / scale[j]
        distance += d * d
    return earlier < 0.0 and here >= 0.0 and math.sqrt(distance) <= 1.5 * h


@kernel
def stability(e, z, p, re, im):
    """Multipliers of the orbit z into re, im (n,), whatever the rank of the boundary-value problem; False on failure."""
    n, m = e.n, e.m
    intervals = (z.size - n - 2) // (m * n + 1)
    w = new_points(n, m, intervals, p)
    s = new_factors(n, m, intervals)
    if not evaluate(e, w, z, True):
        return False
    fill(e, w, z, z, np.ones(z.size), s.local, np.zeros((2, 2)))
    if eliminate(s.local, (m - 1) * n, m * n, 0, intervals, s.local_pivots, s.work) == 0:
        return False
    m_all = np.empty((intervals, n, n))
    fine = transitions(s.local, n, m, m_all)
    skip = 0
    re[:] = math.nan
    if e.forcing == 0:
        skip = 1
        field = np.empty((intervals, n))
        here = np.empty(n)
        for i in range(intervals):
            for k in range(n):
                here[k] = z[i * m * n + k]
            call3(e.value, here, w.p, w.F)
            for k in range(n):
                field[i, k] = w.F[k]
        re[0] = deflate(m_all, field)
        im[0] = 0.0
    q = np.full((n - skip, n - skip), math.nan)
    return fine and multipliers(m_all, skip, q, re, im)
