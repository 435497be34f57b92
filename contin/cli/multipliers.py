"""Multipliers of orbits and maps in words."""

from __future__ import annotations

from collections.abc import Iterable


def multiplier_words(multipliers: Iterable[complex], most: int = 1_000) -> str:
    """From the largest in modulus on, conjugate pairs as one; no more than `most`, then how many are left."""
    known = [complex(m) for m in multipliers if m == m]
    words = []
    for value in sorted(known, key=lambda m: (-abs(m), -m.imag)):
        if value.imag > 0.0:
            words.append(f"{value.real:.6g} ± {value.imag:.6g}i")
        elif value.imag == 0.0:
            words.append(f"{value.real:.6g}")
    left = len(words) - most
    return ", ".join([*words[:most], *([f"and {left} smaller"] if left > 0 else [])]) or "not known"
