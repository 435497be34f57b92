"""Defining systems of special orbits, solved by Newton to full precision (minimally augmented, bordered, sparse).

As `contin.problems.defining`: a matrix B(z) that loses rank is bordered to a regular one, [B b; c^* 0] [V; g] = [0; I];
g(z) = 0 says that B is singular, and dg = -w^* (dB) V.

    LPC   B = derivative of the boundary-value problem by (u, T)
    BPC   B = derivative by (u, T, p), rank deficient by one (two null vectors)
    PD    B = variational equation with v(1) = -v(0)
    NS    B = variational equation with v(1) = exp(i theta) v(0), theta unknown
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.problem import Frame, Sample
from contin.problems.orbits.layout import make_scale
from contin.problems.orbits.linear import OrbitLinear
from contin.problems.orbits.marched_in_kernel import corrected

NEWTON_BUDGET = 12
SETTLED = 1e-13
STALLED = 1e-7
PERTURBATION = 1e-10
SAMPLES = 2
SAME_PERIOD = 1e-3  # relative difference of periods up to which points on two meshes are the same
SAFETY = 2.0  # the finer mesh has an error of its own
UNRESOLVED = 0.2  # distance from 1 of the multiplier on a finer mesh at which a fold by multipliers is none
UNFOLDED = 1e-6  # unfolding parameter (scaled) that a branch point leaves


@dataclass(frozen=True, eq=False)
class Bordered:
    """B (rows, columns) with borders b (rows, corank) and c (columns, kernel), factorised."""

    columns: int
    rows: int
    b: NDArray[Any]
    c: NDArray[Any]
    factors: Any

    @classmethod
    def of(cls, matrix: Any, kernel: int) -> Bordered:
        """Borders that span nearly the null spaces, found by inverse iteration from random ones."""
        rows, columns = matrix.shape
        corank = kernel - (columns - rows)
        generator = np.random.default_rng(7)
        b, c = generator.normal(size=(rows, corank)), generator.normal(size=(columns, kernel))
        bordered = cls.with_borders(matrix, np.linalg.qr(b)[0] if corank else b, np.linalg.qr(c)[0])
        for _ in range(2):
            v, _, w = bordered.solve()
            bordered = cls.with_borders(matrix, np.linalg.qr(w)[0] if corank else b, np.linalg.qr(v)[0])
        return bordered

    @classmethod
    def with_borders(cls, matrix: Any, b: NDArray[Any], c: NDArray[Any]) -> Bordered:
        from scipy import sparse
        from scipy.sparse.linalg import splu

        blocks = [[matrix, sparse.csc_matrix(b)], [sparse.csc_matrix(c.conj().T), None]]
        if b.shape[1] == 0:
            blocks = [[matrix], [sparse.csc_matrix(c.conj().T)]]
        whole = sparse.bmat(blocks, format="csc")
        return cls(matrix.shape[1], matrix.shape[0], b, c, splu(whole))

    def solve(self) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
        """Right vectors V (columns, kernel), g (corank, kernel), left vectors W (rows, corank)."""
        kernel, corank = self.c.shape[1], self.b.shape[1]
        right = np.zeros((self.rows + kernel, kernel), self.c.dtype)
        right[self.rows :] = np.eye(kernel)
        solution = self.factors.solve(right)
        if corank == 0:
            return solution, np.zeros((0, kernel)), np.zeros((self.rows, 0))
        left = np.zeros((self.columns + corank, corank), self.b.dtype)
        left[self.columns :] = np.eye(corank)
        adjoint = self.factors.solve(left, "H")
        return solution[: self.columns], solution[self.columns :], adjoint[: self.rows]


@dataclass(frozen=True, eq=False)
class SolvedOrbit:
    """A special orbit: z, the frequency theta of a pair, scaled residual, error of p.

    Null vectors in scaled unknowns.
    """

    z: Array
    theta: float
    residual: float
    error: float
    right: NDArray[Any]
    left: NDArray[Any]
    confirmed: bool = True  # the same point was found on a finer mesh


def solve_special(problem: Any, type_: str, z: Array, scale: Array, theta: float = 0.0) -> SolvedOrbit | None:
    """Newton on the defining system of LPC, BPC, PD or NS from z; None where it does not converge.

    The error has two parts: how rounding reaches p (scatter of Newton steps from perturbed solutions), and the
    discretisation (the same system on a mesh of half the lengths).
    """
    found = _newton(problem, type_, z, scale, theta)
    if found is None:
        return None
    profile = problem.profile(found.z)
    finer = profile.on_mesh(np.repeat(profile.h / 2.0, 2))
    finer_scale = make_scale(
        finer.h, profile.m, problem.sizes(found.z, scale), float(scale[profile.u.size]), float(scale[-1])
    )
    refined = _newton(problem, type_, finer.vector(), finer_scale, found.theta, samples=0)
    if refined is None:
        return replace(found, error=found.error + float(scale[-1]) * problem.tolerance, confirmed=False)
    discretisation = SAFETY * abs(refined.z[-1] - found.z[-1])
    period = problem.profile(refined.z).period
    confirmed = abs(period - profile.period) < SAME_PERIOD * profile.period
    return replace(found, error=found.error + discretisation, confirmed=confirmed)


def flat_fold(problem: Any, z: Array, scale: Array) -> SolvedOrbit | None:
    """A fold where the parameter is constant to rounding (a canard explosion), z where the multiplier passes 1.

    The defining system is singular to rounding there. The error is the change of the parameter on a mesh of half the
    lengths, at the same period; None where the multiplier there is not near 1, so that it is not resolved.
    """
    linear = OrbitLinear(problem, z, scale, z)
    right, _, left = Bordered.of(linear.jacobian[:, :-1], 1).solve()
    found = same_period_on_finer_mesh(problem, z, scale)
    if found is None:
        return None
    multipliers = problem.multipliers(found)[1:]
    if not float(np.min(np.abs(multipliers - 1.0))) < UNRESOLVED:
        return None
    residual = float(np.max(np.abs(linear.residual)))
    return SolvedOrbit(z, 0.0, residual, 2.0 * abs(float(found[-1] - z[-1])), right, left)


def same_period_on_finer_mesh(problem: Any, z: Array, scale: Array) -> Array | None:
    """The orbit of the same period on a mesh of half the lengths."""
    profile = problem.profile(z)
    finer = profile.on_mesh(np.repeat(profile.h / 2.0, 2))
    finer_scale = make_scale(
        finer.h, profile.m, problem.sizes(z, scale), float(scale[profile.u.size]), float(scale[-1])
    )
    fixed = np.zeros(finer_scale.size)
    fixed[finer.u.size] = 1.0
    guess = Sample(finer.vector(), fixed, np.zeros(4), 0, np.empty(0, complex))
    found: Array | None = corrected(problem, guess, Frame(finer_scale), 1e-7)
    return found


def _newton(
    problem: Any, type_: str, z: Array, scale: Array, theta: float, samples: int = SAMPLES
) -> SolvedOrbit | None:
    try:
        return _Newton(problem, type_, z, scale, theta).run(samples)
    except (RuntimeError, np.linalg.LinAlgError, ValueError):  # SuperLU: exactly singular, or not finite
        return None


class _Newton:
    """One defining system: fixed reference and borders."""

    def __init__(self, problem: Any, type_: str, z: Array, scale: Array, theta: float) -> None:
        self.problem, self.type, self.scale, self.reference = problem, type_, scale, z
        linear = self.linear(z)
        self.extra = {"NS": 1, "BPC": 1}.get(type_, 0)  # theta, or the unfolding of a branch point
        self.width = linear.nu + 2
        bordered = Bordered.of(self.matrix(linear, theta), 2 if type_ == "BPC" else 1)
        self.b, self.c = bordered.b, bordered.c
        self.x = np.concatenate([z[linear.unknowns] / linear.units, [theta] if type_ == "NS" else [0.0] * self.extra])
        self.right: NDArray[Any] = np.empty(0)
        self.left: NDArray[Any] = np.empty(0)

    def linear(self, z: Array) -> OrbitLinear:
        return OrbitLinear(self.problem, z, self.scale, self.reference)

    def matrix(self, linear: OrbitLinear, theta: float) -> Any:
        if self.type == "LPC":
            return linear.jacobian[:, :-1]
        if self.type == "BPC":
            return linear.jacobian
        return linear.variational(-1.0 if self.type == "PD" else complex(np.exp(1j * theta)))

    def z(self, x: Array) -> Array:
        z = self.reference.copy()
        unknowns = np.append(np.arange(self.width - 1), z.size - 1)
        z[unknowns] = x[: self.width] * self.scale[unknowns]
        return z

    def system(self, x: Array) -> tuple[Array, Any]:
        """Equations and their sparse Jacobian at x = (scaled unknowns, extra)."""
        from scipy import sparse

        linear = self.linear(self.z(x))
        theta = float(x[-1]) if self.type == "NS" else 0.0
        v, g, w = Bordered.with_borders(self.matrix(linear, theta), self.b, self.c).solve()
        self.right, self.left = v, w
        equations = [linear.residual]
        blocks = [linear.jacobian]
        if self.type == "BPC":
            equations[0] = equations[0] + x[-1] * self.b[:, 0]
            for k in range(2):
                equations.append(g[0, k : k + 1])
                blocks.append(-(w.T @ linear.hessian(v[:, k])))
            column = np.concatenate([self.b[:, 0], np.zeros(2)])[:, None]
            return np.concatenate(equations), sparse.hstack([sparse.vstack(blocks), column], format="csc")
        if self.type == "LPC":
            gradient = -(w.T @ linear.hessian(np.append(v[:, 0], 0.0)))[0]
        else:
            gradient = -(w.conj().T @ linear.hessian(v[:, 0], variational=True))[0]
        if self.type != "NS":
            blocks.append(np.real(gradient)[None, :])
            return np.append(linear.residual, np.real(g[0, 0])), sparse.vstack(blocks, format="csc")
        rho = complex(np.exp(1j * theta))
        by_angle = -(w.conj().T @ linear.variational_by_angle(rho, v[:, 0]))[0]
        top = sparse.hstack([linear.jacobian, np.zeros((linear.nu + 1, 1))])
        rows = np.array([[*gradient.real, by_angle.real], [*gradient.imag, by_angle.imag]])
        return np.concatenate([linear.residual, [g[0, 0].real, g[0, 0].imag]]), sparse.vstack([top, rows], format="csc")

    def run(self, samples: int) -> SolvedOrbit | None:
        from scipy.sparse.linalg import splu

        x, before = self.x, np.inf
        factors: Any = None
        for _ in range(NEWTON_BUDGET):
            value, matrix = self.system(x)
            factors = splu(matrix)
            step = factors.solve(-value)
            size = float(np.linalg.norm(step))
            if not np.isfinite(size) or size > 1e2 or (size >= before and before < STALLED and size > STALLED):
                return None
            if size >= 0.5 * before and size < STALLED:
                break
            x = x + step
            if size < SETTLED:
                break
            before = size
        else:
            return None
        value, _ = self.system(x)
        if self.type == "BPC" and abs(float(x[-1])) > UNFOLDED:
            return None
        right, left = self.right, self.left
        generator = np.random.default_rng(12345)
        scatter = 0.0
        for _ in range(samples):
            shift = PERTURBATION * generator.uniform(-1.0, 1.0, x.size) / np.sqrt(x.size)
            corrected = shift - factors.solve(self.system(x + shift)[0])
            scatter = max(scatter, abs(float(corrected[self.width - 1])))
        theta = float(x[-1]) if self.type == "NS" else 0.0
        return SolvedOrbit(
            self.z(x), theta, float(np.max(np.abs(value))), 2.0 * scatter * float(self.scale[-1]), right, left
        )


def crossing(linear: OrbitLinear, kernel: Array, left: Array) -> list[Array]:
    """Unit tangents (scaled x) of the two families that cross at a branch point: roots of left . D^2F[t, t] = 0."""
    second = [linear.hessian(kernel[:, k]) for k in range(2)]
    c = np.array([[float(left @ (second[i] @ kernel[:, j])) for j in range(2)] for i in range(2)])
    values, vectors = np.linalg.eigh(0.5 * (c + c.T))
    if values[0] * values[1] >= 0.0:
        return []
    ratio = np.sqrt(-values[0] / values[1])
    tangents = []
    for sign in (1.0, -1.0):
        t = kernel @ (vectors[:, 0] + sign * ratio * vectors[:, 1])
        tangents.append(t / np.linalg.norm(t))
    return tangents
