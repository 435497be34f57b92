"""Coefficients of points of codimension two of cycles: those of the return map, by the functions for maps.

CPC, GPD and CH are stated as rates, as b, c and d of LPC, PD and NS are, in the same coordinate xi and time t:

    CPC   xi' = c xi^3,                    c = c_map a^2 / T
    GPD   xi' = e xi^5,                    e = -e_map a^4 / T        (the map is w -> -w - T e w^5 + ...)
    CH    |xi|' = l2 |xi|^5,               l2 = l2_map a^4 / T       (|w| -> |w| + T l2 |w|^5 + ...)

where w = a xi: a is the length of the eigenfunction v across the cycle at the section, in the length of the map's
eigenvector. R1 to R4, LPPD, LPNS, PDNS and NSNS have the coefficients of the return map in xi (De Witte, Della Rossa,
Govaerts and Kuznetsov, SIAM J. Appl. Dyn. Syst. 12 (2013) 722, have those of the flow: p_jk / T, and the same theta,
delta and s): what is stated does not depend on the section, but for the phase of v there, which B and D of R3 and R4
have, and the sign of the map's eigenvector of multiplier 1 (e of LPPD; f200, f011 and g110 of LPNS).

They are computed on two meshes, the point being located on each. Errors of a coefficient: rounding, and the change to
the finer mesh, which decides, too: a case is stated where it is the same for the return maps of both meshes and for
maps as far beyond the one and the other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation.problem import Verified
from contin.machine import elementary
from contin.normalforms.jet import DerivativeJet, Kind, Real
from contin.normalforms.modes_of_maps import critical_angles
from contin.normalforms.point import normal_form
from contin.normalforms.result import DEGENERATE, NO_FORM, NormalForm
from contin.problems.algebraic_states import massless
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.normal_forms.double_multiplier import with_double_eigenvalue
from contin.problems.orbits.normal_forms.normal_form import eigenfunction
from contin.problems.orbits.normal_forms.return_map import ReturnMap
from contin.special.table import special_type

if TYPE_CHECKING:
    from contin.systems.protocol import System

BEYOND: Final = 2.0  # times the change from mesh to mesh
CRITICAL: Final = 1e-3  # distance of the return map's multiplier from the critical one: it is not resolved beyond that
AS_THEY_ARE: Final = ("s", "case", "theta", "angle", "angle1", "angle2", "resonance")  # of a map's form
UNDECIDED: Final = f"{DEGENERATE}: its sign changes within the error"


def has_coefficients(type_: str, system: System) -> bool:
    """Whether there are any for points of this type; of states without mass there is no return map."""
    return bool(special_type(type_).powers) and not massless(system).any()


def with_coefficients(point: Verified, theta: float, coarse: OrbitLinear, fine: OrbitLinear) -> Verified:
    """The point with coefficients and their errors, or the remark why they could not be computed.

    theta : the angle of the critical multiplier.  coarse, fine : the cycle on two meshes.
    """
    try:
        form = _form(point.type, theta, coarse, fine)
    except NO_FORM as reason:
        return replace(point, remark=f"{point.type}: its normal form could not be computed ({reason})")
    return replace(point, normal_form=form)


def _form(type_: str, theta: float, coarse: OrbitLinear, fine: OrbitLinear) -> dict[str, object]:
    maps = [ReturnMap(coarse)]
    maps.append(ReturnMap(fine, like=maps[0]))
    jets = [each.jet() for each in maps]
    critical = [_critical(type_, theta, jet) for jet in jets]
    for jet, multipliers in zip(jets, critical, strict=True):
        if not all(np.min(np.abs(np.linalg.eigvals(jet.A) - rho)) < CRITICAL for rho in multipliers):
            raise np.linalg.LinAlgError("the multipliers are not resolved there")
    cosine = special_type(type_).cosine
    if cosine in (1.0, -1.0):
        jets = [replace(jet, A=with_double_eigenvalue(jet.A, float(cosine))) for jet in jets]
    lengths = [np.array([_length(each, rho) for rho in those]) for each, those in zip(maps, critical, strict=True)]
    beyond = [(1.0 + BEYOND, -BEYOND), (-BEYOND, 1.0 + BEYOND)]
    own = _scaled(type_, normal_form(type_, jets[0], frequency=theta), lengths[0], coarse)
    others = [_scaled(type_, normal_form(type_, jets[1], frequency=theta), lengths[1], fine)]
    for a, b in beyond:
        form = normal_form(type_, Combined(jets[0], jets[1], a, b), frequency=theta)
        others.append(_scaled(type_, form, a * lengths[0] + b * lengths[1], coarse))
    return _stated(type_, own, others)


def _critical(type_: str, theta: float, jet: DerivativeJet) -> tuple[complex, ...]:
    """The critical multipliers, one of each pair, on the unit circle: in the order of the powers of their lengths."""
    modes = special_type(type_).modes
    if modes is None:
        return (complex(elementary.exp(1j * theta)),)
    real, pairs = modes
    return (*map(complex, real), *(complex(elementary.exp(1j * angle)) for angle in critical_angles(jet, pairs)))


def _length(cycle: ReturnMap, rho: complex) -> float:
    """Of the eigenfunction across the cycle at the section, in that of a unit vector there."""
    real = abs(rho.imag) < np.finfo(float).eps * 8.0
    v = eigenfunction(cycle.linear, float(np.sign(rho.real)) if real else rho)
    return float(np.linalg.norm(cycle.coordinates(v[0])))


@dataclass(frozen=True, eq=False)
class Scaled:
    """A map's form in the eigenfunctions' lengths."""

    coefficients: dict[str, object]
    errors: dict[str, float]


def _scaled(type_: str, form: NormalForm, lengths: Array, linear: OrbitLinear) -> Scaled:
    row = special_type(type_)
    unit = row.rate / linear.profile.period if row.rate else 1.0
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
