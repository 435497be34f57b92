"""Stable and unstable manifolds of the saddles of a flow: one-dimensional, two halves each.

Near a saddle u with eigenvalue l and eigenvector v the manifold is u + s v + s^2 h + O(s^3), (2 l - A) h = D^2f[v, v]/2
(the flow on it is s' = l s + O(s^2) along v). The trajectory from s = `AWAY` of the window is drawn; its distance from
the manifold is of order s^3 there, and shrinks along the unstable one (backwards in time: along the stable one).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.machine import elementary
from contin.plane.field import PlanarField
from contin.plane.flights import Flight, fly
from contin.plane.rest import Rest

AWAY: Final = 1e-3


@dataclass(frozen=True, eq=False)
class Separatrix:
    """A half of a saddle's manifold, from the saddle on; `kind`: stable or unstable, `of`: which equilibrium."""

    of: int
    kind: str
    flight: Flight


def separatrices(field: PlanarField, known: Sequence[Rest], window: Array) -> list[Separatrix]:
    """All halves, two stable and two unstable ones a saddle."""
    widths = window[:, 1] - window[:, 0]
    found = []
    for k, rest in enumerate(known):
        if rest.stability != "saddle":
            continue
        for column, kind in ((0, "stable"), (1, "unstable")):
            rate = float(rest.eigenvalues[column].real)
            v = np.real(rest.vectors[:, column])
            v = v / float(np.max(np.abs(v) / widths))
            bend = _bend(field, rest, rate, v, widths)
            for side in (AWAY, -AWAY):
                start = rest.u + side * v + side * side * bend
                sense = 1 if kind == "unstable" else -1
                flight = fly(field, start, sense, window, known, least=elementary.log(1.0 / AWAY) / abs(rate))
                points = np.vstack([rest.u, flight.points])
                found.append(Separatrix(k, kind, Flight(points, sense, flight.end, flight.rest)))
    return found


def _bend(field: PlanarField, rest: Rest, rate: float, v: Array, widths: Array) -> Array:
    """h of the head; zero where the equations have no second derivative there."""
    values, vectors = rest.eigenvalues, rest.vectors
    half = 0.5 * field.bend(rest.u, v, widths)
    if not np.all(np.isfinite(half)):
        return np.zeros(2)
    matrix = np.real(vectors @ np.diag(values) @ np.linalg.inv(vectors))
    return np.asarray(np.linalg.solve(2.0 * rate * np.eye(2) - matrix, half))
