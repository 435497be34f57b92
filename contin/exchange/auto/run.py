"""What AUTO's constants ask for, as entries of a run file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from contin.exchange.auto.constants import Constants
from contin.records import Fields

_SETTINGS: Final = {"dsmax": "max_step", "nmx": "steps", "ntst": "intervals", "ncol": "points"}


def run_of(found: Constants, parameters: Mapping[int, str]) -> Fields | None:
    """A continuation in the first free parameter over RL0 ... RL1 or the values where AUTO stops; None without."""
    if not found.free:
        return None
    first = found.free[0]
    name = parameters.get(int(first)) if first.isdigit() else next((n for n in parameters.values() if n == first), None)
    stops = sorted(found.stops.get(first, []))
    low = found.numbers.get("rl0", stops[0] if stops else None)
    high = found.numbers.get("rl1", stops[-1] if len(stops) > 1 else None)
    if name is None or low is None or high is None or not low < high:
        return None
    settings = {
        key: found.numbers[constant] if key == "max_step" else int(found.numbers[constant])
        for constant, key in _SETTINGS.items()
        if constant in found.numbers and found.numbers[constant] > 0
    }
    return {"continuations": [{"name": "auto", "parameter": name, "range": [low, high], "settings": settings}]}
