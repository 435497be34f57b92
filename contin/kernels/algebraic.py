"""Pseudo-arclength march along F(u, p) = 0 in one kernel call; the model is a pointer.

All algebra is done in scaled unknowns y = z / D, z = (u, p), with rows scaled alike: M = [D_u^-1 F_z D ; t^T]. Then the
metric is Euclidean, the u-block is similar to F_u (its eigenvalues are those of F_u), and rescaling a state by a power
of two changes no bit of the result. One step costs about one evaluation of F and its Jacobian, one LU and one QR.

Test functions of a point (the columns of `tests`):
    0  dp/ds, zero at folds          1  det M / |det M at the chunk's first row|, zero at branch points
    2  pairs, 3  flips               see `tests_of_stability`
"""

import math

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.between import guess_between, is_between
from contin.kernels.compile import call4, kernel
from contin.kernels.dense import lu_factor, lu_solve
from contin.kernels.eigen import eigenvalues
from contin.kernels.grading import grade, uniform_rates
from contin.kernels.steering import (
    ACCEPTED,
    AT_CORNER,
    BOUND,
    CORNER,
    CORRECTOR,
    LIMIT,
    LOOP,
    NOT_FINITE,
    RESCALE,
    RESCALE_AT,
    STAGNATION,
    STALLED,
    STRAYED,
    crossed,
    judged,
    leaves,
    met,
    next_step,
    passes_start,
    recall,
    record,
    set_out,
    shortened,
    turn,
)
from contin.kernels.tests_of_stability import flow_tests, map_tests

TESTS = 4
BY_PLACE = 2  # of them, those that need no eigenvalues: dp/ds and the determinant
NEWTON_LIMIT = 7
MET = 1e-6  # of the sum of the moduli of an equation's linear terms: what may be left of it at a row's Jacobian
LANDED = 1e-9  # a step that ends on a zero of a test function, where signs say nothing, is repeated a little shorter


@kernel("i, b, f1, f1, i, f1, f1, f1, f2, f2, f2 -> b")
def linearise(address, is_map, z, p, active, scale, tangent, f, jacobian, matrix, block):
    """Evaluate at z: matrix = [scaled F_z; tangent], block = scaled F_u (for eigenvalues), f = scaled F.

    False if not finite.
    """
    n = f.size
    p[active] = z[n]
    call4(address, z, p, f, jacobian)
    total = 0.0
    for i in range(n):
        inverse = 1.0 / scale[i]
        if is_map:
            f[i] -= z[i]
        f[i] *= inverse
        total += f[i]
        for j in range(n):
            value = jacobian[i, j] * scale[j] * inverse
            block[i, j] = value
            matrix[i, j] = value
            total += value
        if is_map:
            matrix[i, i] -= 1.0
        value = jacobian[i, n + active] * scale[n] * inverse
        matrix[i, n] = value
        total += value
    for j in range(n + 1):
        matrix[n, j] = tangent[j]
    return math.isfinite(total)


@kernel("f2 -> f")
def log_determinant(matrix):
    """log |det| from an LU factorisation; the sign of the diagonal's product is `diagonal_sign`."""
    total = 0.0
    for i in range(matrix.shape[0]):
        total += math.log(abs(matrix[i, i]))
    return total


@kernel("f2 -> f")
def diagonal_sign(matrix):
    """Sign of the product of the diagonal."""
    sign = 1.0
    for i in range(matrix.shape[0]):
        if matrix[i, i] < 0.0:
            sign = -sign
    return sign


@kernel("f1, f2, f1, i, f1 -> b")
def is_met(f, jacobian, z, active, scale):
    """True where what is left of every equation (f, scaled) is within `MET` of the moduli of its linear terms at z."""
    n = f.size
    for i in range(n):
        terms = abs(jacobian[i, n + active] * z[n])
        for j in range(n):
            terms += abs(jacobian[i, j] * z[j])
        if not abs(f[i]) * scale[i] <= MET * terms:
            return False
    return True


@kernel("i, b, f1, f1, f, f1, f1, f1, i, f1, f, f, f1, f2, f2, f2, i1, f1, f1 -> i")
def correct(
    address, is_map, z0, tangent, h, y, z, p, active, scale, tolerance, trust, f, jacobian, matrix, block, pivots,
    step, sizes,
):  # fmt: skip
    """Newton on [F(z0 + D y); tangent . y - h] = 0 from the guess y (in place, with z = z0 + D y).

    A last correction is accepted unseen where quadratic convergence puts it below `trust` times the tolerance: 0 for
    piecewise equations, whose next iterate may see another formula. Where an unknown is far smaller than its scale and
    matters all the same, as p in p exp(x), the Jacobian of the iterate before may be another one: where the
    equations are not met to `MET` of their linear terms there, one more iteration is made.

    On success `matrix` holds LU factors at (nearly) the solution and the permutation's sign is returned (+1 or -1).
    Otherwise 0 (no convergence) or 2 (not finite). sizes[0] is the first correction's length, sizes[1] the iterations.
    """
    n = f.size
    before = math.inf
    first = 0.0
    once_more = True
    for iteration in range(NEWTON_LIMIT):
        sizes[1] = iteration + 1.0
        if not linearise(address, is_map, z, p, active, scale, tangent, f, jacobian, matrix, block):
            return 2
        along = 0.0
        for j in range(n + 1):
            along += tangent[j] * y[j]
        for i in range(n):
            step[i] = -f[i]
        step[n] = h - along
        sign = lu_factor(matrix, pivots)
        if sign == 0:
            return 0
        lu_solve(matrix, pivots, step)
        met = is_met(f, jacobian, z, active, scale)
        size = 0.0
        for j in range(n + 1):
            size += step[j] * step[j]
            y[j] += step[j]
            z[j] = z0[j] + scale[j] * y[j]
        size = math.sqrt(size)
        if iteration == 0:
            first = size
            sizes[0] = size
        if size <= tolerance and (met or not once_more or iteration + 1 == NEWTON_LIMIT):
            return sign
        if not size < 1e3:
            return 0
        if iteration > 0:
            ratio = size / before
            if met and size < 1e-4 and size * ratio * ratio < trust * tolerance:
                return sign  # the next correction, by quadratic convergence, is far below the tolerance
            limit = STAGNATION if trust > 0.0 else 0.01 * STAGNATION
            if ratio > 0.5 and not (size < limit and first > size):
                return 0
            if ratio > STALLED:  # else they fall like a geometric series: beside a singular point, not in rounding
                return sign
        once_more = once_more and size > tolerance
        before = size
    return 0


@kernel("b, f2, i, f, i1, f2, f1, f1, f1, f1, f1, f1, f1, f2 -> i")
def measure(
    is_map, matrix, sign, reference, pivots, block, tangent_out, tests, re, im, near_re, near_im, rates, work
):  # fmt: skip
    """Unit tangent, test functions and eigenvalues from the factors in `matrix`.

    rates (n,), work (n, n) : scratch. Returns the number of unstable ones.
    """
    n = block.shape[0]
    for j in range(n):
        tangent_out[j] = 0.0
    tangent_out[n] = 1.0
    lu_solve(matrix, pivots, tangent_out)
    norm = 0.0
    for j in range(n + 1):
        norm += tangent_out[j] * tangent_out[j]
    norm = math.sqrt(norm)
    for j in range(n + 1):
        tangent_out[j] /= norm
    tests[0] = tangent_out[n]
    # det [F_z; t_old] = det [F_z; t_new] / norm, so the determinant refers to the point's own tangent
    exponent = log_determinant(matrix) + math.log(norm) - reference
    tests[1] = sign * diagonal_sign(matrix) * math.exp(min(max(exponent, -700.0), 700.0))
    graded = grade(block, rates, work)
    eigenvalues(block, re, im, near_re, near_im)
    if is_map:
        return map_tests(re, im, tests)
    if not graded:
        uniform_rates(re, im, rates)
    return flow_tests(re, im, rates, tests)


@kernel("f1 -> i")
def without_time(tests):
    """Tests of eigenvalues become constant, and none is unstable."""
    for i in range(BY_PLACE, TESTS):
        tests[i] = 1.0
    return 0


def memory(n: int, p_size: int) -> tuple[Array | NDArray[np.int64], ...]:
    """Arrays that `probes` and `march` work in, for n equations with so many parameters: their last arguments.

    y, step, z, tangent, old, every (n + 1,), f, rates (n,), sizes (2,), tests (TESTS,), jacobian (n, n + p_size),
    matrix (n + 1, n + 1), block and work (n, n), pivots (n + 1,). One by one: a view in a kernel takes long to compile.
    """
    rows, columns, square = np.ones((6, n + 1)), np.empty((2, n)), np.empty((2, n, n))
    return (
        *rows, *columns, np.empty(2), np.empty(TESTS), np.empty((n, n + p_size)), np.empty((n + 1, n + 1)), square[0],
        square[1], np.empty(n + 1, np.int64),
    )  # fmt: skip


@kernel(
    "i, b, f1, f1, f1, f1, i, f1, f, f, f, f2, f2, f2, f2, f2, i1, "
    "f1, f1, f1, f1, f1, f1, f1, f1, f1, f1, f2, f2, f2, f2, i1"
)
def probes(
    address, is_map, z0, tangent, lengths, p, active, scale, tolerance, trust, reference, z, tangents, tests, re, im,
    unstable, y, step, _z, _tangent, _old, _every, f, rates, sizes, _tests, jacobian, matrix, block, work, pivots,
):  # fmt: skip
    """Solve on the planes tangent . (z - z0) / D = lengths[k] from guesses, the rows of z, and measure there.

    unstable[k] : the count; -1 where Newton fails, -2 where something is not finite.  y, ..., pivots : see `memory`.
    """
    n = z0.size - 1
    for k in range(lengths.size):
        for j in range(n + 1):
            y[j] = (z[k, j] - z0[j]) / scale[j]
        sign = correct(
            address, is_map, z0, tangent, lengths[k], y, z[k], p, active, scale, tolerance, trust, f, jacobian,
            matrix, block, pivots, step, sizes,
        )  # fmt: skip
        if sign == 0 or sign == 2:
            unstable[k] = -1 if sign == 0 else -2
            continue
        re[k, :] = math.nan
        unstable[k] = measure(
            is_map, matrix, sign, reference, pivots, block, tangents[k], tests[k], re[k], im[k], re[k], im[k], rates,
            work,
        )  # fmt: skip


@kernel(
    "i, b, f1, f1, f1, f1, f1, f1, f1, f1, f1, i, f1, f, f, f, f2, f2, f2, f2, f2, i1, "
    "f1, f1, f1, f1, f1, f1, f1, f1, f1, f1, f2, f2, f2, f2, i1"
)
def points_between(
    address, is_map, z0, tangent, a, tangent_a, b, tangent_b, fractions, lengths, p, active, scale, tolerance, trust,
    reference, z, tangents, tests, re, im, unstable, y, step, _z, _tangent, _old, _every, f, rates, sizes, _tests,
    jacobian, matrix, block, work, pivots,
):  # fmt: skip
    """`probes` at fractions of the way from a to b, lengths[0] and lengths[1] from z0; of the others, -1 is set.

    lengths : [of a, of b, memory for one of each fraction]
    """
    s_a, s_b = lengths[0], lengths[1]
    for k in range(fractions.size):
        guess_between(tangent, a, tangent_a, b, tangent_b, scale, s_b - s_a, fractions[k], z, k)
        lengths[2 + k] = s_a + fractions[k] * (s_b - s_a)
    probes(
        address, is_map, z0, tangent, lengths[2:], p, active, scale, tolerance, trust, reference, z, tangents, tests,
        re, im, unstable, y, step, _z, _tangent, _old, _every, f, rates, sizes, _tests, jacobian, matrix, block, work,
        pivots,
    )  # fmt: skip
    for k in range(fractions.size):
        if unstable[k] >= 0 and not is_between(z, k, a, b, scale):
            unstable[k] = -1


@kernel(
    "i, b, f1, i, f1, f1, f1, i, f1, f1, f1, f1, f1, f2, f2, f2, i1, f2, f2, f1, f1, "
    "f1, f1, f1, f1, f1, f1, f1, f1, f1, f1, f2, f2, f2, f2, i1 -> i"
)
def march(
    address, is_map, p, active, scale, bounds, controls, limit, previous_tangent, previous_tests,
    loop_z, loop_tangent, periods, out_z, out_t, out_tests, out_unstable, out_re, out_im, out_h, info,
    y, step, z, tangent, old, every, f, rates, sizes, tests, jacobian, matrix, block, work, pivots,
):  # fmt: skip
    """Follow the curve from row 0 of out_z (with guide tangent out_t[0], scaled) for up to `limit` accepted points.

    controls : [h, h_min, h_max, cos_max_angle, tolerance, h_previous, target_angle, trust, timeless]
        h_previous = 0 where `previous_tangent` and `previous_tests` (tests relative to row 0) are unknown. timeless :
        not 0 where equations only vanish: eigenvalues of their Jacobian mean nothing.
    bounds : [lo, hi] of the parameter.  loop_z : start of the branch, or empty when closing is not looked for.
    out_* : one row a point; out_h[k] is the step that led to row k.
    info : [rows beyond row 0, next h, evaluations, log-determinant reference, test that dipped, h that failed]
    Returns the reason; rows 0 .. info[0] are filled. On EVENT, BOUND, LOOP, DIP and CORNER the last row is beyond
    the event.
    """
    n = scale.size - 1
    h, h_min, h_max, cos_max, tolerance = controls[0], controls[1], controls[2], controls[3], controls[4]
    h_previous, target_angle, trust, timeless = controls[5], controls[6], controls[7], controls[8] != 0.0
    info[:] = 0.0
    info[1] = h
    for j in range(n + 1):
        z[j] = out_z[0, j]
    info[2] += 1
    if not linearise(address, is_map, z, p, active, scale, out_t[0], f, jacobian, matrix, block):
        return NOT_FINITE
    sign = lu_factor(matrix, pivots)
    if sign == 0:
        return CORRECTOR
    reference = log_determinant(matrix)
    out_re[0] = math.nan
    unstable = measure(
        is_map, matrix, sign, reference, pivots, block, tangent, tests, out_re[0], out_im[0], out_re[0], out_im[0],
        rates, work,
    )  # fmt: skip
    if timeless:
        unstable = without_time(tests)
    scale_of_det = abs(tests[1])  # |t| correction of row 0: make its determinant exactly +-1
    if scale_of_det > 0.0:
        reference += math.log(scale_of_det)
        tests[1] /= scale_of_det
    info[3] = reference
    record(tangent, tests, out_t, out_tests, 0)
    out_unstable[0] = unstable
    strayed = 0
    for k in range(limit):
        row = k + 1
        for j in range(n + 1):
            tangent[j] = out_t[k, j]
        recall(out_t, previous_tangent, k, old)
        if k > 0:
            h_previous = out_h[k]
        while True:
            set_out(out_z[k], tangent, old, scale, h, h_previous, y, z)
            sign = correct(
                address, is_map, out_z[k], tangent, h, y, z, p, active, scale, tolerance, trust, f, jacobian, matrix,
                block, pivots, step, sizes,
            )  # fmt: skip
            info[2] += sizes[1]
            length = 0.0
            for j in range(n + 1):
                length += y[j] * y[j]
            if leaves(math.sqrt(length), h, cos_max, tolerance):
                sign = 0
            if sign == 0 or sign == 2:
                if h <= h_min:
                    info[5] = h
                    info[1] = h
                    return NOT_FINITE if sign == 2 else CORRECTOR
                h = max(0.5 * h, h_min)
                continue
            unstable = measure(
                is_map, matrix, sign, reference, pivots, block, out_t[row], tests, out_re[row], out_im[row], out_re[k],
                out_im[k], rates, work,
            )  # fmt: skip
            if timeless:
                unstable = without_time(tests)
            cosine = 0.0
            for j in range(n + 1):
                cosine += tangent[j] * out_t[row, j]
            verdict = judged(
                tests, out_tests, k, previous_tests, 1, False, cosine, cos_max, h, h_min, h_previous, strayed < 8
            )
            if verdict == ACCEPTED and strayed < 8 and h > h_min:
                landed = False
                for i in range(TESTS):
                    landed |= abs(tests[i]) < LANDED * abs(out_tests[k, i])
                if landed:
                    strayed = 8
                    h = max(0.9 * h, h_min)
                    continue
            if verdict in (ACCEPTED, AT_CORNER):
                break
            strayed += verdict == STRAYED
            h = shortened(verdict, h, h_min)
        strayed = 0
        out_h[row] = h
        out_unstable[row] = unstable
        record(z, tests, out_z, out_tests, row)
        info[0] = row
        angle = turn(cosine, target_angle) if verdict != AT_CORNER else target_angle
        h_used = h
        h = next_step(h, angle, target_angle, sizes[0], 0.02, 3.0, sizes[1], 3.0, h_min, h_max)
        info[1] = h
        if verdict == AT_CORNER:
            return CORNER
        if z[n] < bounds[0] or z[n] > bounds[1]:
            return BOUND
        changed = unstable != out_unstable[k] or crossed(tests, out_tests, k)
        what = met(tests, out_tests, k, previous_tests, 0, changed, h_previous, h_used, info)
        if what != LIMIT:
            return what
        if loop_z.size > 0 and passes_start(z, out_z[k], loop_z, loop_tangent, every, periods, scale, h_used):
            return LOOP
        for j in range(n):
            if periods[j] == 0.0 and abs(z[j]) > RESCALE_AT * scale[j] / math.sqrt(n):
                return RESCALE
    return LIMIT
