"""Changes of z that the solutions of the bordered equations stand for, and the unit tangent made from them."""

import math

from contin.kernels.compile import part
from contin.kernels.special_orbits.memory import BPC, LPC, NS, PD


@part
def along_y(c, f, o, row, j, nu, intervals):
    """Component j of the change of z that y[row] stands for (row 3 of NS: of k alone)."""
    change = 0.0
    kind = c.kind
    size = nu + 1 + intervals + 2 + (1 if kind in (NS, BPC) else 0)
    if kind == NS and row == 3:
        change = 1.0 if j == size - 3 else 0.0
    elif j <= nu:
        change = o.y[row, j]
    elif j >= size - 2:
        place = size - 1 - j  # 0: first parameter, 1: second
        change = f.across[place] * o.y[row, nu + 1] + (f.along[place] if row == 1 else 0.0)
    elif kind == BPC and j == size - 3:
        change = o.y[row, nu + 2]
    return change


@part
def tangent_of(c, f, o, nu, intervals, scale, guide, out_t):
    """Unit tangent of the curve into out_t, along `guide`; False where it is not defined."""
    g, dG, size = o.null_combination, o.dG, scale.size
    last = 3
    if c.kind in (LPC, PD):
        last = 2
        g[0] = -dG[0, 2]
        g[1] = dG[0, 1]
        g[2] = 0.0
    else:
        g[0] = dG[0, 2] * dG[1, 3] - dG[0, 3] * dG[1, 2]
        g[1] = dG[0, 3] * dG[1, 1] - dG[0, 1] * dG[1, 3]
        g[2] = dG[0, 1] * dG[1, 2] - dG[0, 2] * dG[1, 1]
    total = 0.0
    along = 0.0
    for j in range(size):
        t = 0.0
        for row in range(last):
            t += g[row] * along_y(c, f, o, row + 1, j, nu, intervals)
        t /= scale[j]
        out_t[j] = t
        total += t * t
        along += t * guide[j]
    if not 0.0 < total < math.inf:
        return False
    norm = math.sqrt(total) if along >= 0.0 else -math.sqrt(total)
    for j in range(size):
        out_t[j] /= norm
    return True
