"""Points of a curve between two of its points: guesses for them, and whether Newton's method has stayed between.

Lengths are those along the tangent of a third point, z / scale is the metric (`contin.continuation.curve`).
"""

from contin.kernels.compile import kernel

POOR = 0.2  # cosine of an angle with the tangent from which on the length along it says little


@kernel("f1, f1, f1, f1, f1, f1, f, f, f2, i")
def guess_between(tangent, a, tangent_a, b, tangent_b, scale, h, x, z, k):
    """Row k of z: the cubic through a and b with their tangents, at a fraction x of the way, which is h long.

    The chord where the parametrisation by the length is poor.
    """
    along_a, along_b = 0.0, 0.0
    for j in range(tangent.size):
        along_a += tangent[j] * tangent_a[j]
        along_b += tangent[j] * tangent_b[j]
    straight = h == 0.0 or min(abs(along_a), abs(along_b)) < POOR
    left = 1.0 - x
    for j in range(tangent.size):
        chord = b[j] - a[j]
        z[k, j] = a[j] + x * chord
        if not straight:
            slope_a = scale[j] * tangent_a[j] * (h / along_a) - chord
            slope_b = scale[j] * tangent_b[j] * (h / along_b) - chord
            z[k, j] += x * left * (left * slope_a - x * slope_b)


@kernel("f2, i, f1, f1, f1 -> b")
def is_between(z, k, a, b, scale):
    """Whether row k of z is no farther from a, and from b, than twice these are from each other."""
    from_a, from_b, whole = 0.0, 0.0, 0.0
    for j in range(a.size):
        from_a += ((z[k, j] - a[j]) / scale[j]) * ((z[k, j] - a[j]) / scale[j])
        from_b += ((z[k, j] - b[j]) / scale[j]) * ((z[k, j] - b[j]) / scale[j])
        whole += ((a[j] - b[j]) / scale[j]) * ((a[j] - b[j]) / scale[j])
    return max(from_a, from_b) <= 4.0 * whole
