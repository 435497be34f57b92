"""Every elementary function against mpmath, against the interpreter's own arithmetic, and in exact cases."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest

from contin.machine import elementary
from contin.machine.elementary import FUNCTIONS
from tests.machine.elementary.sampled import BINARY, EXACT, arguments, compiled, error_in_ulp, mp

ONE_RESULT = [name for name in FUNCTIONS if name != "sincos"]
LARGEST_ERROR = 0.51  # ulp; the second rounding of subnormal results adds up to half of one
LARGEST_ERRORS = {"cosh": 0.64, "sinh": 0.58, "tanh": 0.58}  # of a second term of up to the same size
SMALLEST_NORMAL = 2.0**-1022


def worst_errors(name: str, count: int, seed: int) -> tuple[float, float]:
    """Largest error in ulp among normal and among subnormal results."""
    function, exact = compiled(name), EXACT[name]
    normal = subnormal = 0.0
    for given in arguments(name, count, seed):
        true = exact(*(mp.mpf(x) for x in given))
        if abs(true) >= 2**1024:
            assert math.isinf(function(*given)), given
        elif abs(true) < SMALLEST_NORMAL:
            subnormal = max(subnormal, error_in_ulp(function(*given), true))
        else:
            normal = max(normal, error_in_ulp(function(*given), true))
    return normal, subnormal


@pytest.mark.parametrize("name", ONE_RESULT)
def test_errors_are_hardly_more_than_half_a_unit_in_the_last_place(name):
    normal, subnormal = worst_errors(name, 150, seed=1)
    assert normal < LARGEST_ERRORS.get(name, LARGEST_ERROR)
    assert subnormal < LARGEST_ERROR + 0.5


@pytest.mark.long
@pytest.mark.parametrize("name", ONE_RESULT)
def test_the_same_at_tens_of_thousands_of_arguments(name):
    normal, subnormal = worst_errors(name, 10_000, seed=2)
    assert normal < LARGEST_ERRORS.get(name, LARGEST_ERROR)
    assert subnormal < LARGEST_ERROR + 0.5


@pytest.mark.parametrize("name", ONE_RESULT)
def test_machine_code_has_the_bits_of_the_same_operations_in_the_interpreter(name):
    """Nothing is contracted or reassociated: CPython does every operation of the source by itself, in order."""
    function, source = compiled(name), elementary.source(name)
    for given in arguments(name, 60, seed=3):
        try:
            by_hand = source(*given)
        except ZeroDivisionError:  # Python refuses where IEEE 754 gives infinity
            continue
        assert function(*given).hex() == by_hand.hex(), given


def test_sincos_gives_the_bits_of_sin_and_of_cos():
    for (x,) in arguments("sin", 100):
        assert elementary.source("sincos")(x) == (elementary.sin(x), elementary.cos(x))


@pytest.mark.parametrize("name", ["exp", "log", "sinh", "atan", "asinh", "tanh", "log1p", "expm1"])
def test_increasing_functions_never_fall(name):
    function = compiled(name)
    rng = np.random.default_rng(4)
    for start in [*rng.uniform(0.01, 3, 40), *(2.0**k for k in range(-30, 5))]:
        x = float(start)
        previous = -math.inf
        for _ in range(50):
            value = function(x)
            assert value >= previous, x
            x, previous = math.nextafter(x, math.inf), value


def test_powers_that_are_numbers_are_exact():
    power = compiled("pow")
    rng = np.random.default_rng(5)
    for _ in range(500):
        base, exponent = int(rng.integers(2, 2**17)), int(rng.integers(0, 4))
        assert power(float(base), float(exponent)) == base**exponent
        assert power(float(-base), float(exponent)) == (-base) ** exponent
        x = float(rng.uniform(0.1, 10))
        assert power(x, 1.0) == x
        assert power(float(base * base), 0.5) == base
        assert power(float(base**3), -1 / 3) == pytest.approx(1 / base, rel=2**-51)
    for k in range(-1074, 1024):
        assert power(2.0, float(k)) == math.ldexp(1.0, k)
        assert compiled("exp2")(float(k)) == math.ldexp(1.0, k)


def test_logarithms_of_powers_are_exact():
    for k in range(23):
        assert compiled("log10")(float(10**k)) == k
    for k in range(-1074, 1024):
        assert compiled("log2")(math.ldexp(1.0, k)) == k


def test_hypotenuses_of_pythagorean_triangles_are_exact():
    hypot = compiled("hypot")
    for a in range(2, 60):
        for b in range(1, a):
            for scale in (1.0, 2.0**-500, 2.0**-1060, 2.0**1000):
                assert hypot(scale * (a * a - b * b), scale * 2 * a * b) == scale * (a * a + b * b)


def test_the_hardest_angle_of_double_precision():
    """6381956970095103 * 2^797 is closest of all to a multiple of pi/2 (Muller, Elementary Functions, ch. 11)."""
    x = math.ldexp(6381956970095103, 797)
    assert abs(compiled("cos")(x)) < 1e-18
    assert error_in_ulp(compiled("cos")(x), mp_at_high_precision("cos", x)) < LARGEST_ERROR
    assert error_in_ulp(compiled("tan")(x), mp_at_high_precision("tan", x)) < LARGEST_ERROR


def mp_at_high_precision(name: str, x: float):
    with mp.workprec(2500):
        value = getattr(mp, name)(mp.mpf(Fraction(x).numerator))
    return +value


SPECIAL = [0.0, -0.0, math.inf, -math.inf, math.nan, 1.0, -1.0, 2.0, -3.0, 0.5, -2.5, 5e-324, -5e-324]
SPECIAL += [2.0**-1022, 1.7976931348623157e308, -1.7976931348623157e308, 2.0**53, -(2.0**53) + 1, 1e22, -1e-320]
SPECIAL += [1 - 2.0**-53, 1 + 2.0**-52, 40.0, -40.0, 20.0, 710.0, -746.0, 1024.0, -1075.0]


def by_python(name: str, given: tuple[float, ...]) -> float:
    """The value of Python's math, which follows Annex F of C99 but raises where that gives NaN or infinity."""
    x = given[0]
    try:
        return float(getattr(math, name)(*given))
    except OverflowError:
        odd = name in ("sinh", "expm1") or (name == "pow" and given[1] % 2 == 1)
        return -math.inf if x < 0 and odd else math.inf
    except ValueError:
        if name == "pow" and x == 0:
            return math.copysign(math.inf, x) if given[1] % 2 == 1 else math.inf
        if (name.startswith("log") and x == 0) or (name == "log1p" and x == -1):
            return -math.inf
        if name == "atanh" and abs(x) == 1:
            return math.copysign(math.inf, x)
        return math.nan


@pytest.mark.parametrize("name", ONE_RESULT)
def test_special_values_are_those_of_the_c_standard(name):
    function = compiled(name)
    grid = [(x, y) for x in SPECIAL for y in SPECIAL] if name in BINARY else [(x,) for x in SPECIAL]
    for given in grid:
        if name == "exp2":
            expected = by_python("pow", (2.0, *given))
        else:
            expected = by_python(name, given)
        value = function(*given)
        if math.isnan(expected):
            assert math.isnan(value), given
        elif math.isinf(expected) or expected == 0:
            assert (value, math.copysign(1, value)) == (expected, math.copysign(1, expected)), given
        else:
            assert abs(value - expected) <= math.ulp(expected), given
