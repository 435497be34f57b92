"""Equilibria (fixed points of maps) in the window, with their types."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.api.searches import find_equilibria
from contin.model.model import Model
from contin.plane.field import PlanarField
from contin.plane.types import PlaneType, flow_type
from contin.search.equilibrium_from_guess import Equilibrium
from contin.symbolic.passes.conserved import without_conserved

ROUNDED: Final = 1e-9  # of the largest eigenvalue: a smaller real part (distance from the unit circle) may be none


@dataclass(frozen=True, eq=False)
class Rest:
    """An equilibrium u (2,) and its eigenvalues (multipliers); `stability`: stable, unstable, saddle or neutral."""

    u: Array
    eigenvalues: NDArray[np.complex128]
    vectors: NDArray[np.complex128]  # columns
    type: str
    stability: str
    note: str = ""  # what decided the type, or what is left open, where the eigenvalues do not

    def __str__(self) -> str:
        values = ", ".join(f"{v.real:.6g}" + (f"{v.imag:+.6g}i" if v.imag else "") for v in self.eigenvalues)
        return f"{self.type} at ({self.u[0]:.10g}, {self.u[1]:.10g}), eigenvalues {values}"


def rests(field: PlanarField, window: Array) -> tuple[list[Rest], list[str]]:
    """The equilibria in the window, and notes."""
    box: dict[str, tuple[float, float]] = {
        name: (float(low), float(high)) for name, (low, high) in zip(field.names, window, strict=True)
    }
    planar = field.planar.replace(events=()) if isinstance(field.planar, Model) else field.planar
    found = find_equilibria(planar, box, field.parameters)
    inside = [one.equilibrium for one in found if _inside(one.u, window)]
    known = [described(field, one, window) for one in inside]
    notes = [f"{rest.type} at ({rest.u[0]:.6g}, {rest.u[1]:.6g}): {rest.note}" for rest in known if rest.note]
    return known, [*notes, *_lines(planar)]


def _lines(planar: object) -> list[str]:
    """A note where a linear quantity is conserved: equilibria are no points then."""
    laws = getattr(without_conserved(planar.replace(conserved=True)), "totals", ()) if isinstance(planar, Model) else ()
    words = ["a sum of " + " and ".join(total.law) for total in laws]
    return [f"{law} is conserved: equilibria form lines, of which one point is listed at most" for law in words]


def _inside(u: Array, window: Array) -> bool:
    slack = 1e-9 * (window[:, 1] - window[:, 0])
    return bool(np.all((u >= window[:, 0] - slack) & (u <= window[:, 1] + slack)))


def described(field: PlanarField, one: Equilibrium, window: Array) -> Rest:
    """With the eigenvalues of the Jacobian of the planar field, and the type that they and their errors give."""
    matrix = np.asarray(one.system.jacobian(one.u, one.p)[1])[:, :2]
    values, vectors = np.linalg.eig(matrix)
    order = np.argsort(values.real, kind="stable")
    values, vectors = values[order].astype(complex), vectors[:, order].astype(complex)
    model = one.system.model
    if field.is_map:
        found = PlaneType(*_map_type(values))
    elif isinstance(model, Model):
        found = flow_type(one, model.replace(events=()), window)
    else:
        found = PlaneType(*_type_of_function(values))
    return Rest(one.u.copy(), values, vectors, found.words, found.stability, found.note)


def _type_of_function(values: NDArray[np.complex128]) -> tuple[str, str]:
    """Of a flow whose formulas, and so whose rounding, are not known."""
    size = float(np.abs(values).max())
    if values[0].imag != 0.0:
        growth = float(values[0].real)
        if abs(growth) <= ROUNDED * size:
            return "centre of the linearisation", "neutral"
        return ("stable focus", "stable") if growth < 0.0 else ("unstable focus", "unstable")
    first, second = (float(v) for v in values.real)
    if min(abs(first), abs(second)) <= ROUNDED * size:
        return "degenerate equilibrium", "neutral"
    if first * second < 0.0:
        return "saddle", "saddle"
    return ("stable node", "stable") if first < 0.0 else ("unstable node", "unstable")


def _map_type(values: NDArray[np.complex128]) -> tuple[str, str]:
    away = np.abs(values) - 1.0
    if np.any(np.abs(away) <= ROUNDED):
        return "degenerate fixed point", "neutral"
    if away[0] * away[1] < 0.0:
        flips = bool(np.any(values.real < 0.0))
        return ("saddle with reflection" if flips else "saddle"), "saddle"
    stability = "stable" if away[0] < 0.0 else "unstable"
    return f"{stability} {'focus' if values[0].imag != 0.0 else 'node'}", stability
