"""What an .ode file asks XPP to do, as entries of a run file."""

from __future__ import annotations

from contin.exchange.xpp.declarations import Declared
from contin.records import Fields

TOTAL = 20.0  # XPP's own default


def parameter_ranges(found: Declared) -> dict[str, tuple[float, float]]:
    """Ranges of parameters by their names in small letters: AUTO's for the first parameter (parmin, parmax), that of
    a range integration for the parameter it names."""
    ranges: dict[str, tuple[float, float]] = {}
    options = found.options
    over = options.words.get("rangeover", "").lower()
    low, high = options.number("rangelow"), options.number("rangehigh")
    if over and low is not None and high is not None and low < high:
        ranges[over] = (low, high)
    low, high = options.number("parmin"), options.number("parmax")
    if found.parameters and low is not None and high is not None and low < high:
        ranges[next(iter(found.parameters)).lower()] = (low, high)
    return ranges


def run_of(found: Declared, main: str | None) -> Fields:
    """A simulation over XPP's times, and where AUTO's interval is given a diagram in the first parameter, `main`."""
    options = found.options
    total = options.number("total") or TOTAL
    simulate: Fields = {"name": "simulation", "time": total if total > 0 else TOTAL}
    if (options.number("trans") or 0) > 0:
        simulate["transient"] = options.number("trans")
    run: Fields = {"simulate": [simulate]}
    ends = options.number("parmin"), options.number("parmax")
    if main is not None and None not in ends and ends[0] < ends[1]:  # type: ignore[operator]
        run["diagram"] = {"parameter": main, "range": list(ends), "settings": settings(found)}
    return run


def settings(found: Declared) -> Fields:
    """AUTO's largest step, number of steps and mesh, where they are given."""
    options, chosen = found.options, Fields()
    for name, key in (("dsmax", "max_step"), ("nmax", "steps"), ("ntst", "intervals")):
        value = options.number(name)
        if value is not None and value > 0:
            chosen[key] = value if key == "max_step" else max(int(value), 3)
    return chosen
