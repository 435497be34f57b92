"""Test functions of equilibria and fixed points: bounded, continuous, whatever the units of the states.

From the eigenvalues:

Flows:  pairs      sign of prod (l_i + l_j), size min |l_i + l_j| / (|l_i| + |l_j|): zero at Hopf points and neutral
                   saddles
Maps:   pairs      sign of prod (m_i m_j - 1), size min |m_i m_j - 1| / (1 + |m_i m_j|): zero at Neimark-Sacker points
        flips      sign of prod (m_i + 1), size min |m_i + 1| / (1 + |m_i|): zero at period doublings
The size is the smallest factor, not the product: the product of n(n-1)/2 factors below 1 would vanish for large n.
"""

import math

from contin.kernels.compile import kernel
from contin.kernels.grading import rate_of

STABILITY_NOISE = 1e-13  # an eigenvalue this small beside the rate it is computed from has no sign
PAIR_NOISE = 1e-14  # ... nor a sum this small: in a conservative system l and -l are eigenvalues all along a branch


@kernel("f1, f1, f1, f1 -> i")
def flow_tests(re, im, rates, tests):
    """Fill tests[2] (pairs) and tests[3] (1: no flips in a flow); returns the number of eigenvalues with Re > 0.

    rates (n,) : falling, what the errors of the eigenvalues are in proportion to (see `grading`).
    """
    n = re.size
    unstable = 0
    for i in range(n):
        if re[i] > 0.0 and (re[i] > STABILITY_NOISE * rates[0] or re[i] > STABILITY_NOISE * rate_of(re, im, rates, i)):
            unstable += 1
    sign = 1.0
    size = 1.0
    for i in range(n):
        for j in range(i + 1, n):
            x = re[i] + re[j]
            y = im[i] + im[j]
            scale = math.hypot(re[i], im[i]) + math.hypot(re[j], im[j])
            distance = math.hypot(x, y)
            value = distance / scale if scale > 0.0 else 0.0
            if distance <= PAIR_NOISE * rates[0]:
                noise = PAIR_NOISE * max(rate_of(re, im, rates, i), rate_of(re, im, rates, j))
                value = value if distance > noise else 0.0
            size = min(size, value)
            if y == 0.0 and x < 0.0:  # other complex factors come in conjugate pairs
                sign = -sign
    if n % 4 == 2 or n % 4 == 3:  # n(n-1)/2 negative factors is the stable case: make it positive
        sign = -sign
    tests[2] = sign * size
    tests[3] = 1.0
    return unstable


@kernel("f1, f1, f1 -> i")
def map_tests(re, im, tests):
    """Fill tests[2] (pairs) and tests[3] (flips); returns the number of multipliers outside the unit circle."""
    n = re.size
    unstable = 0
    flip_sign = 1.0
    flip_size = 1.0
    sign = 1.0
    size = 1.0
    for i in range(n):
        modulus = math.hypot(re[i], im[i])
        if modulus > 1.0 + STABILITY_NOISE:
            unstable += 1
        flip_size = min(flip_size, math.hypot(re[i] + 1.0, im[i]) / (1.0 + modulus))
        if im[i] == 0.0 and re[i] < -1.0:
            flip_sign = -flip_sign
        for j in range(i + 1, n):
            x = re[i] * re[j] - im[i] * im[j] - 1.0
            y = re[i] * im[j] + im[i] * re[j]
            scale = 1.0 + modulus * math.hypot(re[j], im[j])
            distance = math.hypot(x, y)
            size = min(size, distance / scale if distance > PAIR_NOISE * scale else 0.0)
            if x > 0.0 and (y == 0.0 or (im[i] != 0.0 and re[i] == re[j] and im[i] == -im[j])):
                sign = -sign
    tests[2] = sign * size
    tests[3] = flip_sign * flip_size
    return unstable
