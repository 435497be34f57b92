"""Further verbs in other units: surveys, exponents, manifolds, planes, tori, deflation, jumps, masses, averages."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

import contin
from contin.model.model import Model
from tests.truth.unit_checks import Check, line, simulated
from tests.truth.unit_models import CUSP, DELAYED, FHN, HENON, NAGUMO, VDP
from tests.truth.units import Verbs, summary

SPIKING = Model(  # integrate and fire, with a slow variable that a spike raises
    "spiking", states={"v": 0, "w": 0.2}, parameters={"I": {"value": 2, "range": [1.6, 4]}, "d": 0.3, "top": 1},
    equations={"v": "I - v - w", "w": "-0.4*w"},
    events=[{"when": "v - top", "direction": "up", "set": {"v": "0", "w": "w + d"}}],
)  # fmt: skip
WEIGHED = Model(  # a pitchfork and a Hopf point of M du/dt = f, z is algebraic
    "weighed", states={"x": 0, "y": 0, "z": 0}, parameters={"p": {"value": -1, "range": [-1, 1]}},
    equations={"x": "p*x - y - x*z", "y": "x + p*y - y*z", "z": "z - x^2 - y^2"},
    mass={"x": {"x": 2, "y": 0.5}, "y": {"y": 1.5}, "z": {"z": 0}},
)  # fmt: skip
FORCED_VDP = Model(
    "forced-van-der-pol", states={"x": 0.1, "y": 0}, forcing={"period": "2*pi/w"},
    parameters={"F": {"value": 0.5, "range": [0.3, 0.8]}, "w": 1.9, "m": 0.4},
    equations={"x": "y", "y": "m*(1 - x^2)*y - x + F*cos(w*t)"},
)  # fmt: skip
SLOW_FORCE = Model(  # its average has no closed form
    "slow-force", states={"x": 1.2, "y": 0}, parameters={"a": {"value": 0.6, "range": [0.05, 1.1]}, "eps": 0.01},
    equations={"x": "y", "y": "-x + eps*(a*y - y*exp(-x^2) - 1e-3*y^3)"},
    averaging={"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}]},
)  # fmt: skip
CLOSED = Model(  # the total x + y is conserved
    "closed", states={"x": 1, "y": 2}, parameters={"k": {"value": 0.5, "range": [0.1, 4]}, "h": 1},
    equations={"x": "k*y - x + h*y*x^2/(1 + x^2)", "y": "x - k*y - h*y*x^2/(1 + x^2)"},
)  # fmt: skip
SURFACE = Model(  # the unstable manifold of rest is z = x^2 + x y
    "surface", states={"x": 0, "y": 0, "z": 0}, parameters={"k": 1.3},
    equations={"x": "x", "y": "k*y", "z": "-(z - x^2 - x*y) + 2*x^2 + (1 + k)*x*y"},
)  # fmt: skip
CHAIN = Model(
    "chain", states={f"u{k}": 0 for k in range(30)}, parameters={"p": {"value": -1, "range": [-1, 1.5]}},
    equations={
        f"u{k}": f"p*u{k} - u{k}^3 + 2*(" + " + ".join(f"u{j} - u{k}" for j in (k - 1, k + 1) if 0 <= j < 30) + ")"
        for k in range(30)
    },
)  # fmt: skip


def placed(names: tuple[str, ...], values: Any) -> tuple[str, dict[str, float], dict[str, str]]:
    return "", dict(zip(names, map(float, values), strict=True)), {}


def surveyed(model: Model, names: tuple[str, ...]) -> Check:
    """What happens first on both sides of each parameter, for each attractor."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        found = contin.survey(verbs.model, names=names, processes=1)
        rows = sorted(found.rows, key=lambda row: (row.attractor, row.parameter))
        points = [
            (side.type, {row.parameter: side.at * verbs.unit(row.parameter)}, {})
            for row in rows for side in (row.below, row.above)
        ]  # fmt: skip
        reasons = [side.reason for row in rows for side in (row.below, row.above)]
        return {"points": points, "reasons": reasons, "attractors": sorted(found.attractors)}

    return check


def exponents(model: Model, time: float) -> Check:
    """Lyapunov exponents of a motion that is no chaos, over a given time."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        clock = 1.0 if model.kind == "map" else verbs.units.time
        found = contin.lyapunov(verbs.model, time=time / clock, transient=time / clock)
        rows = found.exponents / clock
        return {"points": [placed(tuple(f"e{k}" for k in range(len(rows))), rows)], "outcomes": found.outcomes}

    return check


def grown(model: Model, start: Mapping[str, float], length: float, side: str, surface: bool = False) -> Check:
    """The ends of a manifold's orbits; of the surface z = x^2 + x y whether its points lie on it.

    All states are in one unit, in which lengths are.
    """

    def check(verbs: Verbs) -> Mapping[str, Any]:
        unit = verbs.units.of_state(0)
        found = contin.manifold(verbs.model, verbs.new(start), length=length / unit, side=side)
        columns = {n: np.asarray(found.columns[n]) * unit for n in model.state_names}
        if surface:
            off = np.abs(columns["z"] - columns["x"] * (columns["x"] + columns["y"]))
            far = float(np.max(np.abs(columns["x"])))
            return {"points": [], "off": bool(off.max() < 1e-6), "far": far > 0.5 * length, "notes": len(found.notes)}
        orbit = np.asarray(found.columns["orbit"])
        last = [np.flatnonzero(orbit == k)[-1] for k in np.unique(orbit)]
        points = [placed(model.state_names, [columns[n][k] for n in model.state_names]) for k in last]
        return {"points": points, "notes": len(found.notes)}

    return check


def portrayed(model: Model, x: str, y: str) -> Check:
    """A phase plane: equilibria with types, cycles, where separatrices end."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        found = contin.plane(verbs.model, x, y)
        units = np.array([verbs.unit(x), verbs.unit(y)])
        rests = sorted(((r.type, r.stability), *(r.u * units).tolist()) for r in found.rests)
        points = [(rest[0], {x: rest[1], y: rest[2]}, {}) for rest in rests]
        points += [("cycle", {"period": c.period * verbs.unit("period")}, {}) for c in found.cycles]
        ends = sorted((s.kind, s.flight.end) for s in found.separatrices)
        counts = [len(curves) for curves in found.nullclines]
        return {"points": points, "ends": ends, "stable": [c.stable for c in found.cycles], "nullclines": counts}

    return check


def tori(model: Model, parameter: str, start: Mapping[str, float] | None = None, label: str = "") -> Check:
    """Invariant circles from a Neimark-Sacker point, or from where a simulation settles; the first rows."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        bounds = verbs.model.parameter_range(parameter)
        origin: Any = verbs.model
        if label:
            origin = contin.continuation(contin.equilibrium(verbs.model), parameter)[label]
        found = contin.torus(origin, parameter, bounds, settings={"steps": 8})
        rows = {n: np.asarray(found.columns[n]) * verbs.unit(n) for n in (parameter, "rotation")}
        points = [("", {n: float(v[k]) for n, v in rows.items()}, {}) for k in (0, -1)]
        return {"points": points, "ends": [end.reason for end in found.ends], "rows": len(rows[parameter])}

    return check


def deflation(model: Model, parameter: str) -> Check:
    """All branches that deflation finds."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        found = contin.deflated(verbs.model, parameter, verbs.model.parameter_range(parameter), samples=5)
        parts = [summary(verbs, branch, (parameter,)) for branch in found.branches]
        points = sorted((p for part in parts for p in part["points"]), key=lambda p: (p[0], p[1][parameter]))
        return {"points": points, "ends": sorted(str(part["ends"]) for part in parts)}

    return check


def started(model: Model) -> Check:
    """A start that is looked for."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        found = contin.find_start(verbs.model)
        solution: Any = found.solution
        values = np.asarray(solution.u if hasattr(solution, "u") else [solution.period])
        units = [verbs.unit(n) for n in model.state_names] if hasattr(solution, "u") else [verbs.unit("period")]
        return {"points": [placed(tuple(f"v{k}" for k in range(len(values))), values * units)], "how": found.how}

    return check


def averaged(model: Model, form: str, parameter: str, start: Mapping[str, float]) -> tuple[Model, Check]:
    """The averaged model, and folds of it, whose quadrature knows no units."""
    slow = contin.average(model, form=form, reach=25.0)

    def check(verbs: Verbs) -> Mapping[str, Any]:
        first = contin.equilibrium(verbs.model, verbs.new(start))
        return summary(verbs, contin.continuation(first, parameter), (parameter,))

    return slow, check


def jumping(model: Model, time: float) -> Check:
    """A trajectory with jumps: its end and how many there were."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        found = contin.simulate(verbs.model, time=time / verbs.units.time, samples=11)
        last = {n: float(found.columns[n][-1]) * verbs.unit(n) for n in model.state_names}
        return {"points": [("", last, {})], "outcome": found.outcome}

    return check


FURTHER: dict[str, tuple[Model, Check]] = {
    "a survey": (FHN, surveyed(FHN, ("I", "e"))),
    "exponents of a cycle": (VDP, exponents(VDP, 200.0)),
    "exponents of a map": (HENON, exponents(HENON, 400.0)),
    "a curve of a manifold": (NAGUMO, grown(NAGUMO, {"u": 0, "v": 0}, 0.8, "unstable")),
    "a surface of a manifold": (SURFACE, grown(SURFACE, dict.fromkeys("xyz", 0.0), 2.0, "unstable", surface=True)),
    "a phase plane": (FHN, portrayed(FHN, "v", "w")),
    "a phase plane with a cycle": (VDP, portrayed(VDP, "x", "y")),
    "tori of a map": (DELAYED, tori(DELAYED, "r", label="NS1")),
    "tori of a forced flow": (FORCED_VDP, tori(FORCED_VDP, "F")),
    "deflation": (CUSP, deflation(CUSP, "p")),
    "a start that is looked for": (FHN, started(FHN)),
    "an average": averaged(SLOW_FORCE, "polar", "a", {"r": 1.2}),
    "a trajectory with jumps": (SPIKING, jumping(SPIKING, 30.0)),
    "orbits with jumps": (SPIKING, simulated(SPIKING, "I", ("I",), transient=40.0)),
    "a mass matrix": (WEIGHED, line(WEIGHED, {"x": 0, "y": 0, "z": 0}, "p", ("p",))),
    "a conserved total": (CLOSED, line(CLOSED, {"x": 1, "y": 2}, "k", ("k",))),
    "a chain": (CHAIN, line(CHAIN, dict.fromkeys(CHAIN.state_names, 0.0), "p", ("p",))),
}  # fmt: skip
