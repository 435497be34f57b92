"""The borders of a curve of special orbits, carried on from the linearisation at one point to the next."""

import math

from contin.kernels.compile import kernel
from contin.kernels.special_orbits.memory import BPC, LPC, PD

STILL = 1e-8  # a part of the unit tangent this small has no direction


@kernel("i, f1, f1, f2, f2, f2, f2, f1, f1, f1")
def carry(kind, across, along, rows, start, y, v, sizes, scale, tangent):
    """Directions of the parameters (`turn_to`), row and start vector from the null functions y[2] and v[0].

    LPC: across is the direction in which the orbits fold; BPC: it is normal to the curve, along which the branch points
    persist, so that a derivative in its direction says nothing; else it is that of the curve itself.
    """
    n = sizes.size
    nu = y.shape[1] - 3
    last = scale.size - 1
    if kind == LPC:
        turn_to(across, along, scale, 1.0, -y[1, nu + 1])
    elif math.hypot(tangent[last], tangent[last - 1]) > STILL:
        p = tangent[last] / scale[last]
        q = tangent[last - 1] / scale[last - 1]
        a = across[0] * p + across[1] * q
        b = along[0] * p + along[1] * q
        if kind == BPC:
            a, b = -b, a
        turn_to(across, along, scale, a if a >= 0.0 else -a, b if a >= 0.0 else -b)
    if kind == BPC:
        return
    total = (y[2, nu] / scale[nu]) ** 2
    if kind != LPC:
        total += y[2, nu + 1] ** 2
    for k in range(n):
        total += (y[2, k] / sizes[k]) ** 2
    length = math.sqrt(total)
    for k in range(n):
        rows[0, k] = y[2, k] / (sizes[k] * sizes[k] * length)
    rows[0, n] = y[2, nu] / (scale[nu] * scale[nu] * length)
    rows[0, n + 1] = y[2, nu + 1] / length if kind != LPC else 0.0
    if kind == PD:
        total = 0.0
        for k in range(n):
            total += (v[0, k] / sizes[k]) ** 2
        for k in range(n):
            start[k, 0] = v[0, k] / (sizes[k] * sizes[k] * math.sqrt(total))


@kernel("f1, f1, f1, f, f")
def turn_to(across, along, scale, a, b):
    """New directions of the parameters: a `across` + b `along`, and one normal to it, both of scaled length 1."""
    last = scale.size - 1
    x = (a * across[0] + b * along[0]) / scale[last]
    y = (a * across[1] + b * along[1]) / scale[last - 1]
    length = math.hypot(x, y)
    x /= length
    y /= length
    across[0] = x * scale[last]
    across[1] = y * scale[last - 1]
    along[0] = -y * scale[last]
    along[1] = x * scale[last - 1]
