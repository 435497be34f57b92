"""contin beside AUTO-07p on families of periodic orbits, by hand: `python tests/benchmarks/orbits.py`.

Both follow the family born at the same Hopf point on the same mesh (intervals x 4 points) with all detection on, in
steps so short that the step control plays no part. How it is measured: `beside.py`. Every benchmark first asserts its
Hopf point and a period in closed form.
"""

from __future__ import annotations

from math import pi, sin, sqrt
from typing import Any

import systems
from beside import Auto, compare

from contin.api import continuation, equilibrium
from contin.model.model import Model


def family(
    title: str, model: Model, parameter: str, bounds: tuple[float, float], step: float, steps: int, intervals: int,
    hopf: tuple[float, float], line: dict[str, Any], orbits: dict[str, Any],
) -> None:  # fmt: skip
    """hopf: parameter and period of the Hopf point; line, orbits: AUTO's constants up to there, and from there on."""
    born = continuation(equilibrium(model), parameter, bounds)["HB1"]
    assert abs(born.values[parameter] - hopf[0]) < 1e-8 * abs(hopf[0])
    settings = {"intervals": intervals, "points": 4, "steps": steps, "step": step, "max_step": step}

    def work() -> object:
        return continuation(born.switch(), parameter, bounds, settings=settings)

    found = continuation(born.switch(), parameter, bounds, settings=settings)
    assert abs(found.columns["period"][0] - hopf[1]) < 1e-8 * hopf[1]
    auto = Auto.of(model)
    if auto is None:
        return compare(title, found.steps, work, None)
    common = {"NDIM": len(model.states), "NTST": intervals}
    label = auto.from_point("HB", **common, **line)
    constants = common | {"IPS": 2, "IRS": label, "ISP": 2, "ICP": [1, 11], "THL": {11: 0.0}} | orbits
    return compare(title, found.steps, work, lambda: auto.run(**constants))


def brusselator() -> None:
    """n = 2: Hopf point at B = 1 + A^2, period 2 pi / A."""
    line, orbits = {"NMX": 200, "DS": 0.02, "DSMAX": 0.05}, {"NMX": 300, "DS": 0.01, "DSMAX": 0.02}
    family("Brusselator, n = 2", systems.brusselator(), "B", (1.5, 5), 0.004, 300, 50, (2.0, 2 * pi), line, orbits)


def lorenz() -> None:
    """n = 3: Hopf point at rho = s (s + b + 3) / (s - b - 1), omega^2 = b (rho + s)."""
    b, s = 8 / 3, 10.0
    rho = s * (s + b + 3) / (s - b - 1)
    line = {"NMX": 300, "MXBF": -1, "DS": 0.1, "DSMAX": 0.5, "UZSTOP": {1: 26.0}}
    orbits = {"NMX": 300, "DS": -0.05, "DSMAX": 0.1}
    hopf = (rho, 2 * pi / sqrt(b * (rho + s)))
    family("Lorenz, n = 3", systems.lorenz(), "rho", (20, 26), 0.004, 300, 50, hopf, line, orbits)


def coupled() -> None:
    """n = 4."""
    line, orbits = {"NMX": 200, "DS": 0.02, "DSMAX": 0.05}, {"NMX": 300, "DS": 0.01, "DSMAX": 0.02}
    model = systems.two_brusselators()
    family("Two Brusselators, n = 4", model, "B", (1.5, 5), 0.004, 300, 50, (2.0, 2 * pi), line, orbits)


def diffusive(n: int) -> None:
    """The first Hopf point has one half-wave."""
    m, a, b, dx, dy = n // 2, 2.0, 5.45, 0.008, 0.004
    # the mode's eigenvalue of the second difference is -k; trace b - 1 - a^2 - (dx + dy) k = 0
    k = (b - 1 - a * a) / (dx + dy)
    length = 2 * (m + 1) * sin(pi / (2 * (m + 1))) / sqrt(k)
    omega = sqrt((b - 1 - dx * k) * (-a * a - dy * k) + a * a * b)
    line = {"NMX": 40, "DS": 0.02, "DSMAX": 0.05, "UZSTOP": {1: 0.8}}
    orbits = {"NMX": 30, "DS": 0.02, "DSMAX": 0.1}
    model = systems.brusselator_on_a_line(n, 0.4, a, b, dx, dy)
    title = f"Brusselator on a line, n = {n}"
    family(title, model, "L", (0.4, 1.5), 0.02, 30, 20, (length, 2 * pi / omega), line, orbits)


if __name__ == "__main__":
    brusselator()
    lorenz()
    coupled()
    for size in (10, 20, 40):
        diffusive(size)
