"""Coefficients of points of codimension two of cycles from two approximations of their return map, and their errors.

Errors of a coefficient: rounding, and the change from one approximation to the other, which decides, too: a case is
stated where it is the same for both, and for maps as far beyond the one and the other.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.machine import elementary
from contin.normalforms.jet import DerivativeJet, Jet, Kind, Real
from contin.normalforms.modes_of_maps import critical_angles
from contin.normalforms.point import normal_form
from contin.normalforms.result import DEGENERATE, NormalForm
from contin.problems.orbits.normal_forms.double_multiplier import with_double_eigenvalue
from contin.special.table import special_type

BEYOND: Final = 2.0  # times the change from one approximation to the other
CRITICAL: Final = 1e-3  # distance of the return map's multiplier from the critical one: it is not resolved beyond that
AS_THEY_ARE: Final = ("s", "case", "theta", "angle", "angle1", "angle2", "resonance")  # of a map's form
UNDECIDED: Final = f"{DEGENERATE}: its sign changes within the error"


@dataclass(frozen=True, eq=False)
class MeasuredMap:
    """A return map: its derivatives, its time, and what the eigenfunctions' coordinates are measured in.

    length : of the eigenfunction of a critical multiplier (on the unit circle), of the size that the cycles'
    coefficients refer to, in that of the map's eigenvector of length 1.
    """

    jet: DerivativeJet
    period: float
    length: Callable[[complex, Jet], float]


def coefficients_of(
    type_: str, theta: float, maps: tuple[MeasuredMap, MeasuredMap],
    rounded: Callable[[Jet], Sequence[Jet]] = lambda _: (), circles: float = 0.0,
) -> dict[str, object]:  # fmt: skip
    """The normal form of the first map in xi, w = length xi, with errors; raises one of `NO_FORM`.

    theta : the angle of the critical multiplier, of types with one.  rounded : the first map with other errors that the
    second one does not show.  circles : radius, in the sizes of the states, of those that derivatives are taken on.
    """
    jets = [each.jet for each in maps]
    critical = [_critical(type_, theta, jet) for jet in jets]
    for jet, multipliers in zip(jets, critical, strict=True):
        if not all(np.min(np.abs(np.linalg.eigvals(jet.A) - rho)) < CRITICAL for rho in multipliers):
            raise np.linalg.LinAlgError("the multipliers are not resolved there")
    cosine = special_type(type_).cosine
    if cosine in (1.0, -1.0):
        jets = [replace(jet, A=with_double_eigenvalue(jet.A, float(cosine))) for jet in jets]
    lengths = [
        np.array([each.length(rho, jet) for rho in those])
        for each, jet, those in zip(maps, jets, critical, strict=True)
    ]  # fmt: skip
    beyond = [(1.0 + BEYOND, -BEYOND), (-BEYOND, 1.0 + BEYOND)]
    first, second = (each.period for each in maps)
    own = _scaled(type_, normal_form(type_, jets[0], frequency=theta), lengths[0], first)
    others = [_scaled(type_, normal_form(type_, jets[1], frequency=theta), lengths[1], second)]
    for a, b in beyond:
        form = normal_form(type_, Combined(jets[0], jets[1], a, b), frequency=theta)
        others.append(_scaled(type_, form, a * lengths[0] + b * lengths[1], a * first + b * second))
    others += [_scaled(type_, normal_form(type_, jet, frequency=theta), lengths[0], first) for jet in rounded(jets[0])]
    return _stated(type_, _on_circles(type_, own, lengths[0], circles) if circles else own, others)


def _on_circles(type_: str, own: Scaled, lengths: Array, radius: float) -> Scaled:
    """Rounding of derivatives of order k on circles, k! eps / r^k: it decides where the others cancel, or are zero."""
    errors = dict(own.errors)
    for key, powers in special_type(type_).powers.items():
        order = int(np.sum(np.abs(powers))) + 1
        rounding = math.factorial(order) * float(np.finfo(float).eps) / elementary.pow(radius, order)
        if key in errors:
            errors[key] += rounding * float(np.prod(elementary.pow(lengths, powers)))
    return replace(own, errors=errors)


def _critical(type_: str, theta: float, jet: DerivativeJet) -> tuple[complex, ...]:
    """The critical multipliers, one of each pair, on the unit circle: in the order of the powers of their lengths."""
    modes = special_type(type_).modes
    if modes is None:
        return (complex(elementary.exp(1j * theta)),)
    real, pairs = modes
    return (*map(complex, real), *(complex(elementary.exp(1j * angle)) for angle in critical_angles(jet, pairs)))


@dataclass(frozen=True, eq=False)
class Scaled:
    """A map's form in the eigenfunctions' lengths."""

    coefficients: dict[str, object]
    errors: dict[str, float]


def _scaled(type_: str, form: NormalForm, lengths: Array, period: float) -> Scaled:
    row = special_type(type_)
    unit = row.rate / period if row.rate else 1.0
    factors = {key: unit * float(np.prod(elementary.pow(lengths, power))) for key, power in row.powers.items()}
    factors |= dict.fromkeys(row.ratios, 1.0)
    known: dict[str, object] = {key: value for key, value in form.coefficients.items() if key in AS_THEY_ARE}
    for key, factor in factors.items():
        if key in form.coefficients:
            known[key] = (np.asarray(form.coefficients[key]) * factor).tolist()
    return Scaled(known, {key: abs(factors[key]) * error for key, error in form.errors.items() if key in factors})


def _stated(type_: str, own: Scaled, others: list[Scaled]) -> dict[str, object]:
    """The coefficients with their errors; cases and signs only where all agree."""
    found, errors = dict(own.coefficients), {}
    for key, error in own.errors.items():
        apart = [_modulus(np.asarray(o.coefficients.get(key, np.nan)) - own.coefficients[key]) for o in others]
        errors[key] = float(error + np.max(apart))
    if not np.isfinite([errors[key] for key in errors if key not in special_type(type_).ratios]).all():
        raise np.linalg.LinAlgError("the change from mesh to mesh is not finite")
    # Where there is one coefficient alone, its error covers how far the others' are off: they have nothing to add.
    cases = [_decided(each, errors) for each in ((own,) if len(errors) == 1 else (own, *others))]
    common = [part for part in cases[0] if all(part in case for case in cases)]
    if any(case != cases[0] for case in cases):
        common = [UNDECIDED, *(part for part in common if DEGENERATE not in part)]
    for ratio, below in special_type(type_).ratios.items():
        if ratio in errors and not (_modulus(found[below]) > errors[below] and np.isfinite(errors[ratio])):
            del found[ratio], errors[ratio]
            common = [f"{DEGENERATE}: {below} is zero to its estimated error"]
    if "s" in found and "case" in own.coefficients:
        found["s"] = found["s"] if f"s = {found['s']}" in common else 0
    elif "s" in found:
        known = common in (["1"], ["-1"])
        found["s"], common = (found["s"], []) if known else (0, [DEGENERATE])
    if common:
        found["case"] = ", ".join(common)
    return {**found, "errors": errors}


def _modulus(value: object) -> float:
    """Of a real number, or of a complex one as [re, im]."""
    x, y = np.append(np.asarray(value, float), 0.0)[:2]
    return float(elementary.hypot(x, y))


def _decided(form: Scaled, errors: Mapping[str, float]) -> list[str]:
    """What is told: the parts of the map's case, the sign s, or that the only coefficient is zero to its error."""
    if len(errors) == 1:
        (key,) = errors
        return [] if abs(float(form.coefficients[key])) > errors[key] else [DEGENERATE]  # type: ignore[arg-type]
    if "case" in form.coefficients:
        return str(form.coefficients["case"]).split(", ")
    return [str(form.coefficients["s"])]


@dataclass(frozen=True, eq=False)
class Combined:
    """a F + b G of two maps; the weights have the sum 1."""

    first: DerivativeJet
    second: DerivativeJet
    a: float
    b: float
    kind: Kind = "map"
    parameters: int = 0
    _known: dict[tuple[bytes, ...], Vector] = field(default_factory=dict, repr=False)

    @property
    def n(self) -> int:
        return self.first.n

    @property
    def scale(self) -> Real | None:
        return self.first.scale

    @property
    def A(self) -> Real:
        return np.asarray(self.a * self.first.A + self.b * self.second.A)

    @property
    def second_sizes(self) -> Real:
        return np.asarray(np.maximum(self.first.second_sizes, self.second.second_sizes))

    def form(self, *directions: Vector) -> NDArray[np.float64] | Vector:
        return self.a * self.first.form(*directions) + self.b * self.second.form(*directions)
