"""The forms of averaged systems that contin has itself."""

from __future__ import annotations

from typing import Final

FORMS: Final = ("polar", "cartesian", "stokes")
