"""Test functions along a curve of special orbits, and the sense of a curve of folds.

tests 2, 3, 4   pairs, flips (see `contin.kernels.tests_of_stability`) and ones of the multipliers that are neither
                trivial nor critical; ones: sign of prod (1 - m_i), size min |m_i - 1| / (1 + |m_i|)
LPC   5         speed: component of the tangent along the curve in the plane of the parameters, zero at a cusp
NS    5 - 8     k - 1, k + 1, k + 1/2, k: zero at R1, R2, R3, R4
PD 5, NS 9      not known here (NaN): the coefficient of the normal form

Next to a resonance (R1 of LPC, R2 of PD) the multiplier beside the critical one is known to rounding / its distance
from it, their sum to rounding: it is their sum less what the critical one is. Farther away that would bring the error
of the critical one, which is large along canards, to one that vanishes.
"""

import math

from contin.kernels.compile import kernel
from contin.kernels.special_orbits.memory import LPC, NS, PD
from contin.kernels.tests_of_stability import map_tests

BESIDE = 0.5  # distance from the critical multiplier up to which another one is next to it


@kernel("i, f1, f1, f, f, f1, f1, f1, f1 -> i")
def special_tests(kind, re, im, k, speed, others_re, others_im, four, tests):
    """Fill tests, of which 0 and 1 are not used, from the nontrivial multipliers; k is the further unknown of NS.

    Returns how many of the multipliers that are not critical are unstable.

    others_re, others_im : memory for those that are not critical.  four : (4,) memory.
    """
    for i in range(tests.size):
        tests[i] = 1.0
    first = -1
    second = -1
    for i in range(2 if kind == NS else 1):
        found = nearest(kind, re, im, k, 1.0 - 2.0 * i, first)
        if i == 0:
            first = found
        else:
            second = found
    beside = -1
    if kind != NS and re.size > 1:
        beside = nearest(kind, re, im, k, 1.0, first)
        apart = math.hypot(re[beside] - (-1.0 if kind == PD else 1.0), im[beside])
        if apart > BESIDE or (im[beside] != 0.0 and im[beside] != -im[first]):
            beside = -1
    left = 0
    for i in range(re.size):
        if i == beside:
            others_re[left] = re[i] + (re[first] - (-1.0 if kind == PD else 1.0))
            others_im[left] = 0.0
            left += 1
        elif i != first and i != second:
            others_re[left] = re[i]
            others_im[left] = im[i]
            left += 1
    count = 0
    if left > 0:
        count = map_tests(others_re, others_im, four)
        tests[2] = four[2] if left > 1 else 1.0
        tests[3] = four[3]
        sign = 1.0
        size = math.inf
        for i in range(left):
            if others_im[i] == 0.0 and others_re[i] < 1.0:
                sign = -sign
            distance = math.hypot(others_re[i] - 1.0, others_im[i])
            size = min(size, distance / (1.0 + math.hypot(others_re[i], others_im[i])))
        tests[4] = sign * size
    if kind == LPC:
        tests[5] = speed
    elif kind == NS:
        tests[5] = k - 1.0
        tests[6] = k + 1.0
        tests[7] = k + 0.5
        tests[8] = k
        tests[9] = math.nan
    elif kind == PD:
        tests[5] = math.nan
    return count


@kernel("i, f1, f1, f, f, i -> i")
def nearest(kind, re, im, k, sense, excluded):
    """Index of the multiplier nearest to the critical one c: 1, -1, or of NS a root of m^2 - 2 k m + 1 = 0.

    By |m - c|^2 / |m|, which grows with |log m/c|: of one that vanishes and one that is 3 for 1, the latter is it.
    """
    x = 1.0
    y = 0.0
    if kind == PD:
        x = -1.0
    elif kind == NS:
        root = math.sqrt(abs(k * k - 1.0))
        x = k + sense * root if abs(k) > 1.0 else k
        y = 0.0 if abs(k) > 1.0 else sense * root
    found = -1
    least = math.inf
    for i in range(re.size):
        size = math.hypot(re[i], im[i])
        distance = ((re[i] - x) ** 2 + (im[i] - y) ** 2) / size if size > 0.0 else math.inf
        if i != excluded and (found < 0 or distance < least):
            found = i
            least = distance
    return found


@kernel("f1, f1, f, f1, f1, f2, i, f1")
def find_normal(across, along, slope, place, scale, normals, known, normal):
    """Unit normal of a curve of folds in the scaled plane of the parameters, in the sense of the nearest point known.

    It is that of (w F_p, w F_q), w the left null vector, which turns continuously along the curve.  normals (., 5) :
    place (parameters and period, scaled) and normal of `known` points.
    """
    last = scale.size - 1
    normal[0] = (across[0] - slope * along[0]) / scale[last]
    normal[1] = (across[1] - slope * along[1]) / scale[last - 1]
    length = math.hypot(normal[0], normal[1])
    near = -1
    least = math.inf
    for i in range(known):
        distance = abs(normals[i, 0] - place[0]) + abs(normals[i, 1] - place[1]) + abs(normals[i, 2] - place[2])
        if near < 0 or distance < least:
            near = i
            least = distance
    if near >= 0 and normals[near, 3] * normal[0] + normals[near, 4] * normal[1] < 0.0:
        length = -length
    normal[0] /= length
    normal[1] /= length


@kernel("f1, f1, f2, i -> i")
def remember(place, normal, normals, known):
    """Add a place and its normal; returns the new number of known ones."""
    for i in range(3):
        normals[known, i] = place[i]
    normals[known, 3] = normal[0]
    normals[known, 4] = normal[1]
    return known + 1
