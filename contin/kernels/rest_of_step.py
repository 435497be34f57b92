"""Whether test functions at a few points of a step, beside an event that is located, leave room for further ones.

As `contin.continuation.location.rest_of_step` says, which says of what points; here is the arithmetic.
"""

from contin.kernels.compile import inlined, kernel

STRAIGHT = 0.3  # part of its smaller neighbour by which a test may differ from linear interpolation
FALLING = 4.0  # ... and the ratio of neighbours from which interpolation says nothing
CLEAR = 30.0  # times the differences seen: values that are no rounding errors


@inlined("f, f, f, f -> b")
def has_no_room(left, middle, right, fraction):
    """True where a test has no room for two zeros between these values; `fraction`: of the way, the middle one's."""
    if left * middle < 0.0 or middle * right < 0.0:
        return False
    smallest = min(abs(left), abs(middle), abs(right))
    largest = max(abs(left), abs(middle), abs(right))
    bent = abs(middle - left - fraction * (right - left)) > STRAIGHT * smallest
    return not ((bent or largest > FALLING * smallest) and largest > 0.0)


@kernel("f1, f2, f1, f1, f1, i1, b -> b")
def is_clear(near, between, far, places, gaps, crossing, adaptive):
    """True where every test is told from rounding, of one sign, and nearly linear from point to point.

    near, far (k,) : tests at the ends.  between (m, k) : at fractions `places` (m,) of the way, m = 3 or 4: two next to
    the near end, which tell rounding errors, one at the geometric mean of the distances, and the middle.  gaps (m,) :
    distances from the located zero of the near end, of the points but the first two, and of the far end.  crossing (k,)
    : 1 for the tests that vanish there, whose zero is divided out.
    """
    last = places.size - 1
    for i in range(near.size):
        noise = CLEAR * abs(near[i] - 2.0 * between[0, i] + between[1, i])
        left = near[i] if abs(near[i]) > noise else 0.0
        middle = between[2, i] if abs(between[2, i]) > noise else 0.0
        half = between[last, i] if abs(between[last, i]) > noise else 0.0
        right = far[i] if abs(far[i]) > noise else 0.0
        if crossing[i] != 0:
            if adaptive and (left == 0.0 or middle == 0.0 or half == 0.0 or right == 0.0):
                return False
            left /= gaps[0]
            middle /= gaps[1]
            half /= gaps[last - 1]
            right /= gaps[last]
        if left * middle < 0.0 or middle * half < 0.0 or half * right < 0.0:
            return False
        if not has_no_room(left, middle, right, places[2]):
            return False
        if last > 2 and not has_no_room(left, half, right, places[last]):
            return False
    return True


@kernel("f1, f1, f1, f -> b")
def are_straight(left, middle, right, fraction):
    """True where no test (k,) has room for two zeros between these values; `fraction`: see `has_no_room`."""
    straight = True
    for i in range(left.size):
        straight = straight and has_no_room(left[i], middle[i], right[i], fraction)
    return straight
