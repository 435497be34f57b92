"""Manifolds as branches: their columns, and what is not as asked for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contin.abi import Array, Vector
from contin.continuation.branch import Branch, End
from contin.lowering.system import CompiledSystem
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.manifolds.iterated import Grown, MapCurve
from contin.problems.manifolds.segments import Grower, Segment, curve, disc

Table = dict[str, Vector]


def of_flow(grower: Grower, u0: Array, dimension: int, spacing: float) -> tuple[Table, list[str]]:
    """Columns, the states as "u", and what is not as asked for."""
    troubles: list[str] = []
    if dimension == 1:
        left, right = curve(grower)
        middle = Segment(0.0, np.zeros(1), np.zeros(1), u0[None], True)
        parts = [(left, -1.0, slice(None, None, -1)), (middle, 1.0, slice(None)), (right, 1.0, slice(None))]
        table = {
            "orbit": np.concatenate([np.full(len(one.s), k) for k, (one, _, _) in enumerate(parts)]),
            "s": np.concatenate([sign * one.s[order] for one, sign, order in parts]),
            "t": np.concatenate([one.t[order] for one, _, order in parts]),
            "u": np.concatenate([one.u[order] for one, _, order in parts]),
        }
        segments: Sequence[Segment] = (left, right)
    else:
        segments, widest = disc(grower, spacing)
        table = of_surface(segments, grower.samples)
        if widest > spacing:
            troubles.append(
                f"neighbouring orbits part by up to {widest:.3g}, more than the spacing of {spacing:.3g}: their starts "
                "are as near as rounding or the number of orbits allows"
            )
    return table, troubles + too_short(segments)


def of_surface(segments: Sequence[Segment], samples: int) -> Table:
    return {
        "orbit": np.repeat(np.arange(len(segments)), samples),
        "angle": np.repeat([one.angle for one in segments], samples),
        "s": np.concatenate([one.s for one in segments]),
        "t": np.concatenate([one.t for one in segments]),
        "u": np.concatenate([one.u for one in segments]),
    }


def too_short(segments: Sequence[Segment]) -> list[str]:
    short = [one for one in segments if not one.whole]
    if not short:
        return []
    least = min(float(one.s[-1]) for one in short)
    return [f"{len(short)} of {len(segments)} orbits come to rest before the length is reached, one at {least:.6g}"]


def of_map(grower: MapCurve) -> tuple[Table, list[str]]:
    left, right = grower.branch(-1.0), grower.branch(1.0)
    middle = Grown(np.zeros(1), grower.u0[None], "")
    table = {
        "orbit": np.repeat([0, 1, 2], [len(left.s), 1, len(right.s)]),
        "s": np.concatenate([-left.s[::-1], middle.s, right.s]),
        "u": np.concatenate([left.u[::-1], middle.u, right.u]),
    }
    troubles = [
        f"the branch {sense} the eigenvector ends at arclength {one.s[-1]:.6g}: {one.trouble}"
        for sense, one in (("against", left), ("along", right)) if one.trouble
    ]  # fmt: skip
    return table, troubles


def branch_of(
    name: str, system: CompiledSystem, u: Array, p: Array, table: Table, troubles: list[str], seconds: float, what: str,
    of: str = "equilibrium",
) -> Branch:  # fmt: skip
    states = table.pop("u")
    columns = {**table, **{state: states[:, k].copy() for k, state in enumerate(system.state_names)}}
    place = ", ".join(f"{state} = {value:.8g}" for state, value in zip(system.state_names, u, strict=True))
    end = End("bound", f"{what} of the {of} {place}")
    rows = len(states)
    z = np.column_stack([states, np.full(rows, p[0] if len(p) else 0.0)])
    return Branch(
        name, "manifold", (), columns, (), (end, end), z, np.zeros_like(z), np.zeros((rows, 0), complex), 0, rows,
        seconds, {}, EquilibriumProblem(system, p, 0), notes=tuple(troubles),
    )  # fmt: skip
