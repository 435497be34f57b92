"""The march along a curve of special orbits in one kernel call; the model is a pointer."""

import math

from contin.kernels.collocation_steps import predict
from contin.kernels.compile import kernel
from contin.kernels.special_orbits.carry import carried_on
from contin.kernels.special_orbits.correct import correct_special
from contin.kernels.special_orbits.memory import BPC, LPC, NOT_FINITE, NS
from contin.kernels.special_orbits.predict import bring_in_phase, turned_over
from contin.kernels.special_orbits.sides import keep_form, relative
from contin.kernels.special_orbits.tests import find_normal, remember, special_tests
from contin.kernels.special_orbits.turning_off import turning_off
from contin.kernels.steering import BEFORE, BOUND, CORRECTOR, EVENT, GROWTH, LIMIT, RESCALE, TOLD
from contin.kernels.steering import NOT_FINITE as STOP_NOT_FINITE

MARCH, CORRECT, MEASURE = range(3)  # what `follow_special` does
WANTED = 2e-3  # first correction (scaled) that the step control aims at
CAUTION = 5.0  # how much worse Newton's convergence may be at the next points than at the last one
AGAIN = 8  # points for which it is believed
SMALL = 2e-3  # relative amplitude down to which orbits that shrink are followed


@kernel(
    "i, Equations, Curve, Points, Factors, Scratch, Borders, CurveMemory, f1, f1, f1, f1, f2, i, f1, f1, f2, f2, f2, "
    "f2, i1, f2, f2, f1, f1 -> i"
)
def follow_special(
    mode, e, c, w, s, x, f, o, scale, sizes, weights, controls, walls, limit, before_z, before_t, normals, out_z, out_t,
    out_tests, out_unstable, out_re, out_im, out_h, info,
):  # fmt: skip
    """What `mode` says.

    MARCH : follow the curve from row 0, where everything is known, for up to `limit` points. A step that fails, whose
        chord or tangent turns by more than an angle, or that leads beyond a point (an orbit of no extent) is repeated
        with half its length. Returns the reason, as `contin.kernels.algebraic.march`; RESCALE where the orbits shrink
        to a point.
    CORRECT : solve as `correct_special` says on the plane at distance controls[0] from row 0, from the guess in row 1,
        and measure there (row 1). Returns the number of iterations, FAILED or NOT_FINITE.
    MEASURE : ... and carry the borders on to that point.

    controls : [h, h_min, h_max, cos_max_angle, tolerance, h_previous, target_angle, exact]
        h_previous = 0 where `before_*` (point and tangent before row 0) are unknown.
    info : [rows beyond row 0, next h, evaluations, Newton's curvature, first correction, s part of y[1], known rows of
        `normals` (also on entry), determinant at the last row (MARCH: also on entry, at row 0; where that is 0, no
        other curve is looked for), the row before which another curve crosses, the first one before which this curve
        turned off beside another, the length of the step that led to that]; normals has room for `limit` + 1 more.
    """
    n = e.n
    size = scale.size
    nodes = o.y.shape[1] - 3
    autonomous = e.forcing == 0
    here, tangent, before, old, guess, z, t = o.z0, o.t0, o.before, o.old, o.guess, o.zn, o.tn
    place, normal = o.place, o.normal
    winds = False
    for k in range(n):
        winds |= e.winding[k] != 0.0
    h, h_min, h_max, cos_max, tolerance = controls[0], controls[1], controls[2], controls[3], controls[4]
    h_previous, target_angle = controls[5], controls[6]
    exact = controls[7] != 0.0
    marching = mode == MARCH
    for j in range(size):
        here[j] = out_z[0, j]
        tangent[j] = out_t[0, j]
        before[j] = before_z[j]
        old[j] = before_t[j]
        if not marching:
            guess[j] = out_z[1, j]
    lengths = o.lengths
    curvature = math.inf if marching else info[3]
    trusted = 0
    side_before = info[7]
    info[8] = 0.0
    info[9] = 0.0
    info[0] = 0.0
    info[1] = h
    info[2] = 0.0
    for row in range(1, limit + 1):
        iterations = 0
        cosine = 1.0
        looked, crosses, apart = False, False, 0.0
        while True:
            if marching:
                predict(here, tangent, before, old, scale, h, h_previous, guess)
            if autonomous:
                bring_in_phase(guess, here, scale, weights, n, nodes, o.drift)
            info[3] = curvature if trusted < AGAIN else math.inf
            iterations = correct_special(e, c, w, s, x, f, o, scale, sizes, h, tolerance, exact, info)
            info[2] += 1.0
            if not marching:
                break
            beyond = False
            taken = iterations >= 0
            if taken:
                moved = 0.0
                cosine = 0.0
                for j in range(size):
                    moved += ((z[j] - here[j]) / scale[j]) ** 2
                    cosine += tangent[j] * t[j]
                taken = math.sqrt(moved) * cos_max <= h + 10.0 * tolerance
                beyond = taken and not winds and turned_over(here, z, n, nodes, sizes)
                taken = taken and not beyond and cosine >= cos_max
            there = 1.0
            if taken and not looked and side_before != 0.0:
                there = relative(c.kind, side_before, info[7], o)
            if there < 0.0:
                lengths[1] = -there
                apart = turning_off(
                    e, c, w, s, x, f, o, scale, sizes, weights, h, h_previous, cos_max, tolerance, side_before, info,
                    lengths, n, nodes, autonomous,
                )  # fmt: skip
                looked = apart == 0.0 or lengths[0] <= h_min
                crosses = looked and (c.kind == LPC or lengths[1] < max(1.0, -there))
                if not looked and info[9] == 0.0:
                    info[9] = row
                    info[10] = h
                h = h if looked else max(lengths[0] - BEFORE * apart, 0.5 * lengths[0], h_min)
                continue
            if taken:
                break
            if h <= h_min or (beyond and h < SMALL):
                info[1] = h
                if beyond:
                    return RESCALE
                return STOP_NOT_FINITE if iterations == NOT_FINITE else CORRECTOR
            h = max(0.5 * h, h_min)
        if iterations < 0:
            return iterations
        if c.kind == BPC:
            keep_form(o)
        if crosses or 0.0 < apart <= TOLD:
            info[8] = row
        info[5] = o.y[1, nodes + 1]
        speed = 1.0
        if c.kind == LPC:
            known = int(info[6])
            place[0] = z[size - 1] / scale[size - 1]
            place[1] = z[size - 2] / scale[size - 2]
            place[2] = z[nodes] / scale[nodes]
            find_normal(f.across, f.along, info[5], place, scale, normals, known, normal)
            speed = normal[0] * t[size - 2] - normal[1] * t[size - 1]
            if mode != CORRECT or known == 0:
                info[6] = remember(place, normal, normals, known)
        further = z[size - 3] if c.kind == NS else 0.0
        out_unstable[row] = special_tests(c.kind, x.re, x.im, further, speed, o.others_re, o.others_im, o.four, o.tests)
        if mode != CORRECT:
            info[7] = carried_on(c.kind, f.across, f.along, f.rows, f.start, o.y, o.v, sizes, scale, t, info[7])
        side_before = info[7]
        for j in range(size):
            out_z[row, j] = z[j]
            out_t[row, j] = t[j]
        for i in range(o.tests.size):
            out_tests[row, i] = o.tests[i]
        free = x.re.size
        out_re[row, 0] = o.trivial[0]
        out_im[row, 0] = 0.0
        for k in range(free):
            out_re[row, k + n - free] = x.re[k]
            out_im[row, k + n - free] = x.im[k]
        if not marching:
            return iterations
        out_h[row] = h
        info[0] = row
        info[2] += iterations
        trusted = trusted + 1 if iterations == 1 else 0
        curvature = info[3] if iterations == 1 else CAUTION * max(info[3], 1.0)
        angle = math.acos(min(cosine, 1.0))
        factor = GROWTH
        if angle > 0.0:
            factor = min(factor, target_angle / angle)
        if info[4] > 0.0:
            factor = min(factor, (WANTED / info[4]) ** (1.0 / 3.0))
        h_previous = h
        h = min(max(h * max(factor, 0.3), h_min), h_max)
        if apart > 0.0 and not looked:
            h = max(min(h, BEFORE * apart), h_min)
        info[1] = h
        for i in range(walls.shape[0]):
            value = z[size + int(walls[i, 0])]
            if value < walls[i, 1] or value > walls[i, 2]:
                return BOUND
        changed = out_unstable[row] != out_unstable[row - 1]
        for i in range(2, o.tests.size):
            changed |= out_tests[row, i] * out_tests[row - 1, i] < 0.0
        if changed:
            return EVENT
        for j in range(size):
            before[j] = here[j]
            old[j] = tangent[j]
            here[j] = z[j]
            tangent[j] = t[j]
    return LIMIT
