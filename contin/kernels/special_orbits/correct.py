"""Newton on a curve of special orbits, and what is measured at the solution."""

import math

from contin.kernels.collocation import set_phase
from contin.kernels.collocation_march import floquet
from contin.kernels.compile import kernel
from contin.kernels.dense import lu_factor, lu_solve
from contin.kernels.special_orbits.linearise import linearise
from contin.kernels.special_orbits.memory import FAILED
from contin.kernels.special_orbits.tangent import changes, combined, product, tangent_of
from contin.kernels.steering import STALLED

ITERATIONS = 12
STAGNATION = 1e-7


@kernel("Equations, Curve, Points, Factors, Scratch, Borders, CurveMemory, f1, f1, f, f, b, f1 -> i")
def correct_special(e, c, w, s, x, f, o, scale, sizes, length, tolerance, exact, info):
    """Newton on the plane <o.t0, (z - o.z0) / scale> = length from o.guess, into o.zn, with tangent o.tn.

    `exact`: all is measured at the solution itself, else with the matrices of the last iteration; tolerance inf:
    nothing is solved. info[3]: the second correction beside the square of the first; on entry the last known of these,
    inf where one iteration is never enough. info[4]: size of the first correction. info[7]: see `tangent_of`.
    Returns the number of iterations, FAILED or NOT_FINITE.
    """
    z, z0, out_z, out_t, guess, tangent = o.z, o.z0, o.zn, o.tn, o.guess, o.t0
    size = scale.size
    intervals = w.h.size
    nu = (intervals * e.m + 1) * e.n
    last = z.size - 1
    small, dG, G, g, d, step = o.small, o.dG, o.G, o.combination, o.changes, o.step
    unknowns = small.shape[0]
    for j in range(size):
        out_z[j] = guess[j]
    set_phase(e, w, guess, sizes)
    before = math.inf
    done = not tolerance < math.inf
    final = done
    info[4] = 0.0
    iteration = 0
    while True:
        for j in range(nu + 1 + intervals):
            z[j] = out_z[j]
        z[last] = out_z[size - 1]
        status = linearise(e, c, w, s, f, o, sizes, out_z[size - 2], out_z[size - 3])
        if status != 0:
            return status
        changes(c.kind, f.across, f.along, o.y, scale, d)
        if final:
            break
        for row in range(unknowns - 1):
            for col in range(unknowns):
                small[row, col] = dG[row, col + 1]
            g[row] = -(G[row] + dG[row, 0])
        rest = length
        for j in range(size):
            rest -= tangent[j] * (out_z[j] - z0[j]) / scale[j]
        for row in range(unknowns + 1):
            along = product(d, row, tangent)
            if row == 0:
                rest -= along
            else:
                small[unknowns - 1, row - 1] = along
        g[unknowns - 1] = rest
        if lu_factor(small, o.small_pivots) == 0:
            return FAILED
        lu_solve(small, o.small_pivots, g)
        moved = combined(d, 1.0, g, unknowns, step)
        for j in range(size):
            out_z[j] += scale[j] * step[j]
        iteration += 1
        if iteration == 1:
            info[4] = moved
        if not moved < 1e2 or not out_z[nu] > 0.0:
            return FAILED
        ratio = moved / before
        if iteration == 1:
            done = moved <= tolerance or info[3] * moved * moved < 0.03 * tolerance
        elif moved <= tolerance or (moved < 1e-4 and moved * ratio * ratio < 0.1 * tolerance):
            done = True
        elif ratio > 0.5 and moved >= STAGNATION:
            return FAILED
        elif ratio > STALLED:  # else they fall like a geometric series: beside a singular point, not in rounding
            done = True
        elif iteration >= ITERATIONS:
            return FAILED
        if iteration == 2:
            info[3] = moved / (before * before)
        before = moved
        if done:
            if not exact:
                break
            final = True
    info[7] = tangent_of(c.kind, dG, d, o.null_combination, tangent, out_t)
    if info[7] == 0.0:
        return FAILED
    for k in range(x.re.size):
        x.re[k] = math.nan
    for j in range(z.size):
        x.z[j] = z[j]
    o.trivial[0] = floquet(e, w, s, x)
    return iteration
