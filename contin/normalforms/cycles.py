"""Coefficients of folds, period doublings and torus bifurcations of cycles u0(t) of M u' = f(u), by projections.

    LPC   tau' = 1 - xi + ...,       xi' = b xi^2 + ...        (b alone, tau' = 1, where the period does not change)
    PD    tau' = 1 + a xi^2 + ...,   xi' = c xi^3 + ...
    NS    tau' = 1 + a |xi|^2 + ..., xi' = (i theta / T) xi + d xi |xi|^2 + ...

(Kuznetsov, Govaerts, Doedel and Dhooge, SIAM J. Numer. Anal. 43 (2005) 1407). A, B and C are the derivatives of f along
the cycle; p is a left null vector, <p, g> vanishing where M w' = A w + g, w(T) = rho w(0) has a solution. How such
equations are solved is the discretisation's (`Cycle`, `Equation`); functions are its values at its points.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

from contin.abi import Vector
from contin.machine import elementary
from contin.normalforms.coefficient import Coefficient


class Equation(Protocol):
    """M w' = A w + g, w(T) = rho w(0), along a cycle."""

    @property
    def null(self) -> tuple[Vector, Vector]:
        """Right null vector and left one, where rho is a multiplier."""

    def projection(self, g: Vector, left: Vector | None = None) -> complex:
        """<p, g>, of arbitrary scale; `left` is another p than the own null vector."""

    def modulus(self, g: Vector, left: Vector | None = None) -> float:
        """Sum of the moduli of the terms of `projection`."""

    def solve(self, g: Vector, singular: bool) -> Vector:
        """A solution, that of a bordered equation where it is `singular`."""


class Cycle(Protocol):
    """What coefficients ask of a cycle; `values` of a solution are those that derivatives and projections take."""

    @property
    def period(self) -> float: ...

    @property
    def autonomous(self) -> bool: ...

    @property
    def rates(self) -> Vector:
        """f(u0), which is M u0'."""

    def equation(self, rho: complex, name: str = "") -> Equation:
        """Equations of one name have borders in common with those of cycles nearby; one that is known serves again."""

    def values(self, w: Vector) -> Vector: ...

    def weighed(self, w: Vector) -> Vector:
        """M w"""

    def first(self, w: Vector) -> Vector:
        """A w"""

    def apply(self, *functions: Vector) -> Vector:
        """B[v, w] or C[v, w, x]"""

    def normalised(self, w: Vector) -> Vector:
        """w (a solution) with mean square 1 over the cycle, of the states with mass."""

    def across_fold(self) -> tuple[Vector, Vector | None]:
        """v (a solution) and, where the phase does not drift along it, p, v' = A v; None: M v' = A v + M u0'."""


def coefficient(cycle: Cycle, type_: str, theta: float) -> Coefficient:
    """b of LPC, c of PD or d of NS.  theta : the angle of the multipliers of NS."""
    if type_ == "LPC":
        return fold(cycle)
    return period_doubling(cycle) if type_ == "PD" else torus(cycle, theta)


def fold(cycle: Cycle) -> Coefficient:
    """b = <p, B(v, v) / 2 + A v> / <p, M v> with M v' = A v + M u0'; b = <p, B(v, v)> / (2 <p, M v>) with M v' = A v
    where the period does not change across the fold, or is forced.
    """
    periodic = cycle.equation(1.0)
    w, p = cycle.across_fold()
    v = cycle.values(w)
    if p is not None:
        return replace(_projected(cycle, periodic, v, [0.5 * cycle.apply(v, v)], p), signed=False)
    return _projected(cycle, periodic, v, [0.5 * cycle.apply(v, v), cycle.first(v)])


def period_doubling(cycle: Cycle) -> Coefficient:
    """c = <p, C(v, v, v) + 3 B(v, h2) - 6 a A v> / (6 <p, M v>)."""
    periodic, antiperiodic = cycle.equation(1.0, "periodic"), cycle.equation(-1.0, "critical")
    v = cycle.values(cycle.normalised(antiperiodic.null[0]))
    a, h2 = _second_order(cycle, periodic, cycle.apply(v, v), factor=0.5)
    terms = [cycle.apply(v, v, v) / 6.0, 0.5 * cycle.apply(v, h2), -a * cycle.first(v)]
    return _projected(cycle, antiperiodic, v, terms)


def torus(cycle: Cycle, theta: float) -> Coefficient:
    """d = <p, C(v, v, v') + 2 B(h11, v) + B(h20, v') - 2 a A v> / (2 <p, M v>) + i a theta / T (v' the conjugate).

    Functions stand for w = v exp(i theta tau / T), which solve the variational equation with w(T) = exp(i theta) w(0).
    """
    periodic = cycle.equation(1.0, "periodic")
    turning = cycle.equation(complex(elementary.exp(1j * theta)), "critical")
    v = cycle.values(cycle.normalised(turning.null[0]))
    a, h11 = _second_order(cycle, periodic, cycle.apply(v, v.conj()).real, factor=1.0)
    twice = cycle.equation(complex(elementary.exp(2j * theta)))
    h20 = cycle.values(twice.solve(cycle.apply(v, v), singular=False))
    terms = [
        0.5 * cycle.apply(v, v, v.conj()), cycle.apply(h11, v), 0.5 * cycle.apply(h20, v.conj()), -a * cycle.first(v),
    ]  # fmt: skip
    d = _projected(cycle, turning, v, terms)
    return replace(d, value=d.value + 1j * a * theta / cycle.period)


def _second_order(cycle: Cycle, periodic: Equation, g: Vector, factor: float) -> tuple[float, Vector]:
    """a = factor <p, g> / <p, M u0'> and the periodic h, M h' = A h + g - (a / factor) M u0'; forced: a = 0."""
    if not cycle.autonomous:
        return 0.0, cycle.values(periodic.solve(g, singular=False))
    a = float((periodic.projection(g) / periodic.projection(cycle.rates)).real)
    return factor * a, cycle.values(periodic.solve(g - a * cycle.rates, singular=True))


def _projected(
    cycle: Cycle, critical: Equation, v: Vector, terms: list[Vector], left: Vector | None = None
) -> Coefficient:
    """Sum of the terms' projections in units of M v's.

    The moduli are those of the integrands, so that a projection which vanishes by symmetry has a size, too.
    """
    unit = critical.projection(cycle.weighed(v), left)
    parts = [critical.projection(g, left) / unit for g in terms]
    return Coefficient(complex(sum(parts)), float(sum(critical.modulus(g, left) for g in terms) / abs(unit)))
