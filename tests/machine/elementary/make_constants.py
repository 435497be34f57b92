"""Writes contin/machine/elementary/constants.py from mpmath: `python tests/machine/elementary/make_constants.py`."""

from __future__ import annotations

from pathlib import Path

import mpmath

CONSTANTS = Path(__file__).parents[3] / "contin" / "machine" / "elementary" / "constants.py"
HEAD = '''"""Constants and tables of the elementary functions, written by tests/machine/elementary/make_constants.py.

High and low parts are consecutive roundings of one number; SHORT and the parts of pi/32 have fewer bits, so that their
products with small integers are exact. EXP_TABLE[2 j], [2 j + 1]: 2^(j/128). LOG_TABLE[3 j ...]: c, and -log c in two
parts, c the rounding to ten bits of the reciprocal of the centre of cell j. SINE_TABLE[4 k ...]: sine of k pi/32 in two
parts, its cosine in 26 bits and the rest. ATAN_TABLE[2 j], [2 j + 1]: atan(j/32). PER_TWO_PI_WORDS: 64 zeros and the
first 1408 binary digits of 1/(2 pi).
"""

'''


def to_bits(x: mpmath.mpf, n: int) -> float:
    """x rounded to n significant bits."""
    if x == 0:
        return 0.0
    unit = mpmath.mpf(2) ** (int(mpmath.floor(mpmath.log(abs(x), 2))) + 1 - n)
    return float(mpmath.nint(x / unit) * unit)


def to_multiple(x: mpmath.mpf, power: int) -> float:
    """x rounded to a multiple of 2^power."""
    return float(mpmath.ldexp(mpmath.nint(mpmath.ldexp(x, -power)), power))


def pair(x: mpmath.mpf) -> tuple[float, float]:
    high = float(x)
    return high, float(x - high)


def constants() -> dict[str, float | tuple[float, ...] | tuple[int, ...]]:
    mpmath.mp.prec = 2000
    ln2, pi = mpmath.log(2), mpmath.pi * 1
    short = to_bits(ln2 / 128, 33)
    first = to_bits(pi / 32, 33)
    second = to_bits(pi / 32 - first, 33)
    log_cells: list[float] = []
    lowest = 0x3FF0000000000000 - (1 << 44) - 75 * (1 << 45)
    for j in range(128):
        centre = lowest + (1 << 44) + (j << 45)
        exponent, fraction = (centre >> 52) - 1023, centre & ((1 << 52) - 1)
        m = mpmath.ldexp(1 + mpmath.ldexp(mpmath.mpf(fraction), -52), exponent)
        c = to_bits(1 / m, 10)
        high = to_multiple(-mpmath.log(c), -42)
        log_cells += [c, high, float(-mpmath.log(c) - high)]
    sines: list[float] = []
    for k in range(64):
        s, c = (mpmath.mpf(0) if k % 32 == 0 else mpmath.sin(k * pi / 32)), mpmath.cos(k * pi / 32)
        if k % 32 == 16:
            s, c = mpmath.mpf(1 if k == 16 else -1), mpmath.mpf(0)
        if k % 32 == 0:
            c = mpmath.mpf(1 if k == 0 else -1)
        high = to_bits(c, 26)
        sines += [*pair(s), high, float(c - high)]
    digits = int(mpmath.floor(mpmath.ldexp(1 / (2 * pi), 1408)))
    words = [0, *((digits >> (64 * (21 - i))) & 0xFFFFFFFFFFFFFFFF for i in range(22))]
    ln2_short = to_multiple(ln2, -42)
    return {
        "LN2_HIGH": pair(ln2)[0],
        "LN2_LOW": pair(ln2)[1],
        "LN2_HIGH_SHORT": ln2_short,
        "LN2_LOW_SHORT": float(ln2 - ln2_short),
        "PER_LN2_128": float(128 / ln2),
        "LN2_128_HIGH": short,
        "LN2_128_LOW": float(ln2 / 128 - short),
        "PER_LN2_HIGH": pair(1 / ln2)[0],
        "PER_LN2_LOW": pair(1 / ln2)[1],
        "PER_LN10_HIGH": pair(1 / mpmath.log(10))[0],
        "PER_LN10_LOW": pair(1 / mpmath.log(10))[1],
        "PI_HIGH": pair(pi)[0],
        "PI_LOW": pair(pi)[1],
        "HALF_PI_HIGH": pair(pi / 2)[0],
        "HALF_PI_LOW": pair(pi / 2)[1],
        "PER_PI_32": float(32 / pi),
        "PI_32_HIGH": pair(pi / 32)[0],
        "PI_32_LOW": pair(pi / 32)[1],
        "PI_32_FIRST": first,
        "PI_32_SECOND": second,
        "PI_32_THIRD": float(pi / 32 - first - second),
        "EXP_TABLE": tuple(part for j in range(128) for part in pair(mpmath.mpf(2) ** (mpmath.mpf(j) / 128))),
        "LOG_TABLE": tuple(log_cells),
        "SINE_TABLE": tuple(sines),
        "ATAN_TABLE": tuple(part for j in range(33) for part in pair(mpmath.atan(mpmath.mpf(j) / 32))),
        "PER_TWO_PI_WORDS": tuple(words),
    }


def text() -> str:
    lines = [HEAD]
    for name, value in constants().items():
        if isinstance(value, float):
            lines.append(f"{name} = {value!r}\n")
            continue
        lines.append(f"{name} = (\n")
        written = [f"0x{v:016X}" if isinstance(v, int) else repr(v + 0.0) for v in value]
        lines += [f"    {', '.join(written[i : i + 4])},\n" for i in range(0, len(written), 4)]
        lines.append(")  # fmt: skip\n")
    return "".join(lines)


if __name__ == "__main__":
    CONSTANTS.write_text(text(), encoding="utf-8")
