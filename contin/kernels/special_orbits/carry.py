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


@kernel("i, f1, f1, f2, f2, f2, f2, f1, f1, f1, f -> f")
def carried_on(kind, across, along, rows, start, y, v, sizes, scale, tangent, side):
    """`carry`, and the determinant `side` of `tangent_of` in the coordinates of the new borders.

    They are r and the row's value, on the plane of y[1] and y[2], where these are (1, 0) and (0, 1) for the borders
    before. Where orbits change one way with one parameter and the opposite way with the other, a turn of the parameters
    by less than a right angle gives them another sense: seen in the coordinates before, another curve would cross.
    That of BPC, whose form has coordinates, too, stays as it is.
    """
    n = sizes.size
    nu = y.shape[1] - 3
    last = scale.size - 1
    p1 = across[0] * y[1, nu + 1] + along[0]
    q1 = across[1] * y[1, nu + 1] + along[1]
    p2 = across[0] * y[2, nu + 1]
    q2 = across[1] * y[2, nu + 1]
    carry(kind, across, along, rows, start, y, v, sizes, scale, tangent)
    if kind == BPC:
        return side
    unit = scale[last] * scale[last]
    other = scale[last - 1] * scale[last - 1]
    r1 = p1 * along[0] / unit + q1 * along[1] / other
    r2 = p2 * along[0] / unit + q2 * along[1] / other
    row1 = rows[0, n] * y[1, nu] + rows[0, n + 1] * (p1 * across[0] / unit + q1 * across[1] / other)
    row2 = rows[0, n] * y[2, nu] + rows[0, n + 1] * (p2 * across[0] / unit + q2 * across[1] / other)
    for k in range(n):
        row1 += rows[0, k] * y[1, k]
        row2 += rows[0, k] * y[2, k]
    turned = r1 * row2 - r2 * row1
    return side / turned if turned != 0.0 else 0.0


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
