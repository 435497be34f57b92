"""Small models in two parameters: normal forms with known curves, hidden by changes of coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

import contin
from contin.continuation.branch import Branch
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from tests.problems.follow import model

BOX = {"p": (-1.0, 1.0), "q": (-1.0, 1.0)}


@dataclass(frozen=True)
class Plane:
    """w' = field(w, p, q) with states w0, w1, ...; a branch in p starts at `start` with q fixed."""

    field: tuple[str, ...]
    start: tuple[float, ...]
    at: Mapping[str, float]
    box: Mapping[str, tuple[float, float]] = None  # type: ignore[assignment]

    def model(self, seed: int | None = None, units: Sequence[float] | None = None):
        """The field in its own coordinates (`seed` None), or in x with w = S(M x): S shears, M is well conditioned.

        z = M x, w_i = z_i + c_i z_(i-1)^2, so that z_i' = field_i - 2 c_i z_(i-1) z_(i-1)'. `units` multiply x.
        """
        n = len(self.field)
        if seed is None:
            matrix, shears = np.eye(n), np.zeros(n)
        else:
            random = np.random.default_rng(seed)
            turn, _ = np.linalg.qr(random.normal(size=(n, n)))
            matrix, shears = turn @ np.diag(random.uniform(0.5, 2.0, n)) @ turn.T, random.uniform(-0.3, 0.3, n)
        scale = np.ones(n) if units is None else np.asarray(units, dtype=float)
        inverse = np.linalg.inv(matrix)
        definitions = {}
        for i in range(n):
            definitions[f"z{i}"] = " + ".join(f"({float(matrix[i, k] / scale[k])!r})*x{k}" for k in range(n))
            shear = f" + ({float(shears[i])!r})*z{i - 1}^2" if i else ""
            definitions[f"w{i}"] = f"z{i}{shear}"
            turn_rate = f" - 2*({float(shears[i])!r})*z{i - 1}*v{i - 1}" if i else ""
            definitions[f"v{i}"] = f"{self.field[i]}{turn_rate}"
        equations = {
            f"x{k}": " + ".join(f"({float(scale[k] * inverse[k, i])!r})*v{i}" for i in range(n)) for k in range(n)
        }
        z = np.zeros(n)
        for i in range(n):
            z[i] = self.start[i] - (shears[i] * z[i - 1] ** 2 if i else 0.0)
        x = scale * (inverse @ z)
        states = {f"x{k}": float(x[k]) for k in range(n)}
        return model(equations, states, dict(self.at), definitions=definitions)

    def line(self, seed: int | None = None, units: Sequence[float] | None = None, **options) -> Branch:
        """The branch of equilibria in p."""
        system = self.model(seed, units)
        return contin.continuation(contin.equilibrium(system), "p", (self.box or BOX)["p"], **options)

    def curve(self, label: str, seed: int | None = None, names=("p", "q"), **options) -> Branch:
        """The curve in the plane from a label of the line."""
        return follow(self.line(seed)[label], names, self.box or BOX, **options)


def follow(point, names=("p", "q"), box=BOX, **options) -> Branch:
    return contin.continuation(point.locus(names), names, box, **options)


def curves_through(point, names=("p", "q"), box=BOX, orbits: bool = False, **options) -> list[Branch]:
    """Every curve of equilibria (of orbits) that a point of codimension two offers."""
    seeds = [seed for seed in point.locus(names) if isinstance(seed.problem, LocusProblem) != orbits]
    return [contin.continuation(seed, names, box, **options) for seed in seeds]


def found(branch: Branch, names=("p", "q")) -> list[tuple]:
    """(type, first, second) of the labelled points, sorted."""
    return sorted((p.type, *(p.values[name] for name in names)) for p in branch.points)


def assert_points(branch: Branch, expected: Sequence[tuple], atol: float = 1e-9, names=("p", "q")) -> None:
    """Exactly these points of codimension two."""
    points, wanted = found(branch, names), sorted(expected)
    assert [p[0] for p in points] == [p[0] for p in wanted], f"{points} instead of {wanted}; notes {branch.notes}"
    left = list(wanted)
    for point in points:
        match = min((w for w in left if w[0] == point[0]), key=lambda w: np.hypot(w[1] - point[1], w[2] - point[2]))
        np.testing.assert_allclose(point[1:], match[1:], atol=atol, rtol=0)
        left.remove(match)


def columns(branch: Branch, *names: str):
    return tuple(branch.columns[name] for name in names)


def amplitude(first: str, second: str, growth: str, turn: str) -> tuple[str, str]:
    """(Re, Im)' of z' = (growth + i turn) z."""
    return f"({growth})*{first} - ({turn})*{second}", f"({turn})*{first} + ({growth})*{second}"


# Normal forms of Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., secs. 8.2 - 8.6
CUSP = Plane(("p + q*w0 - w0^3", "-2*w1"), (1.3247179572447458, 0.0), {"p": 1.0, "q": 1.0})
BOGDANOV_TAKENS = Plane(("w1", "p + q*w0 + w0^2 - w0*w1"), (-1.0, 0.0), {"p": -0.5, "q": -0.5})
BAUTIN = Plane(amplitude("w0", "w1", "p + q*(w0^2 + w1^2) - (w0^2 + w1^2)^2", "1"), (0.0, 0.0), {"p": -0.5, "q": 0.5})
DOUBLE_HOPF = Plane(
    (
        *amplitude("w0", "w1", "p - 0.5*q - (w0^2 + w1^2) - 3*(w2^2 + w3^2)", "1"),
        *amplitude("w2", "w3", "q + 0.25*p - 2*(w0^2 + w1^2) - (w2^2 + w3^2)", "2.3"),
    ),
    (0.0, 0.0, 0.0, 0.0), {"p": -0.9, "q": -0.1},
)  # fmt: skip


def zero_hopf(s: int, theta: float) -> Plane:
    """w0' = p + w0^2 + s |z|^2, z' = (q + theta w0 + w0^2 + i) z."""
    return Plane(
        (f"p + w0^2 + ({s})*(w1^2 + w2^2)", *amplitude("w1", "w2", f"q + ({theta})*w0 + w0^2", "1.4")),
        (-0.95, 0.0, 0.0), {"p": -0.9025, "q": -0.05},
    )  # fmt: skip


TRANSCRITICAL = Plane(("w0*(p + q*w0 - w0^2)", "w0^2 - w1"), (0.0, 0.0), {"p": -0.5, "q": 0.7})
PITCHFORK = Plane(("w0*(p + q*w0^2 - w0^4)", "-w1"), (0.0, 0.0), {"p": -0.5, "q": 0.7})
