"""A problem of a package's own: Chandrasekhar's H-equation, an integral equation of radiative transfer.

H(x) = 1 + (c/2) H(x) int_0^1 x/(x + y) H(y) dy on Gauss's nodes x_i with weights w_i. Its solutions meet in a fold at
c = 1, and s = sum w_i H_i = 2/c (1 -+ sqrt(1 - c)), whatever the number of nodes (Chandrasekhar, Radiative Transfer,
1960, sec. 38).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contin.continuation import march as python_march
from contin.continuation.outcome import Outcome, Rejected, Verified
from contin.continuation.problem import Problem
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.linalg.newton import Rules, by_steps, solution, with_one_fixed
from contin.problems.dense_march import DenseLinearisation, dense_linearisation

ERROR = 1e-12  # scaled, of a fold: many times the rounding errors of its defining system


@dataclass(frozen=True, eq=False)
class Scattering(Problem):
    """z = (H_1, ..., H_N, c)."""

    nodes: int = 12
    kind = "algebraic"  # solutions of equations without time
    locus = None
    parameters = ("c",)
    maximum_chunk = 20

    @property
    def rule(self) -> tuple[np.ndarray, np.ndarray]:
        x, w = np.polynomial.legendre.leggauss(self.nodes)
        return (x + 1.0) / 2.0, w / 2.0

    @property
    def kernel(self) -> np.ndarray:
        x, w = self.rule
        return w * x[:, None] / (x[:, None] + x) / 2.0

    def linearise(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """F (N,) and [F_H F_c] (N, N + 1)."""
        h, c = z[:-1], z[-1]
        inner = self.kernel @ h
        by_h = np.eye(self.nodes) - c * (np.diag(inner) + h[:, None] * self.kernel)
        return h - 1.0 - c * h * inner, np.column_stack([by_h, -h * inner])

    # -- what the march in Python asks for ---------------------------------------------------------------------------

    @property
    def angle_periods(self) -> np.ndarray:
        return np.zeros(self.nodes)

    def linearisation(self, z: np.ndarray, tangent: np.ndarray, scale: np.ndarray) -> DenseLinearisation | None:
        return dense_linearisation(*self.linearise(z), tangent, scale)

    def stability(self, z: np.ndarray) -> tuple[np.ndarray, int, np.ndarray]:
        return np.zeros(0), 0, np.zeros(0, complex)  # tests 0 and 1, of folds and branch points, are the march's own

    # -- the engine's contract ----------------------------------------------------------------------------------------

    def initial_scale(self, z: np.ndarray, bounds: tuple[float, float]) -> np.ndarray:
        return np.append(np.sqrt(self.nodes) * np.abs(z[:-1]).max() * np.ones(self.nodes), bounds[1] - bounds[0])

    def tangents(self, z: np.ndarray, scale: np.ndarray) -> Sequence[np.ndarray]:
        found = python_march.null_vector(self, z, scale, np.eye(z.size)[-1], 2)
        return [] if found is None else [found]

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        return python_march.march(self, origin, before, length, frame, step, limit, bounds, settings, loop)

    def probe(self, base: Sample, length: float, guess: np.ndarray, frame: Frame, settings: Settings) -> Sample | None:
        return python_march.probe(self, base, length, guess, frame, settings)

    def at_parameter(self, guess: np.ndarray, value: float, scale: np.ndarray) -> np.ndarray | None:
        return with_one_fixed(self.linearise, self.nodes, guess, value, scale)

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return ("LP",) if a.tests[0] * b.tests[0] < 0.0 < a.tests[1] * b.tests[1] else ()

    def test_of(self, type_: str) -> int | None:
        return 0 if type_ == "LP" else None

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        """Newton on F = 0, F_H v = 0, |v| = 1 for (H, c, v)."""
        n, scale = self.nodes, np.append(frame.scale, np.ones(self.nodes))

        def missed(x: np.ndarray) -> np.ndarray:
            f, jacobian = self.linearise(x[: n + 1])
            v = x[n + 1 :]
            return np.concatenate([f, jacobian[:, :n] @ v, [v @ v - 1.0]])

        def step(x: np.ndarray) -> np.ndarray | None:  # `missed` is a polynomial: complex steps are exact
            columns = [missed(x + 1e-20j * d).imag / 1e-20 for d in np.diag(scale)]
            return solution(np.array(columns).T, -missed(x))

        start = np.concatenate([near.z, near.tangent[:n] / np.linalg.norm(near.tangent[:n])])
        found = by_steps(step, start, scale, Rules(settled=1e-14, far=1.0))
        if found is None:
            return Rejected("the defining system of a fold has no solution nearby")
        z = found.at[: n + 1]
        left = float(np.abs(missed(found.at)).max())
        return Verified(type_, z, left, ERROR * float(scale[n]), np.zeros(0, complex), 0)

    # -- words and columns --------------------------------------------------------------------------------------------

    def columns(self, z: np.ndarray) -> dict[str, np.ndarray]:
        return {"c": z[:, -1], "s": z[:, :-1] @ self.rule[1]}

    def column_names(self) -> Sequence[str]:
        return "c", "s"

    def constants(self) -> dict[str, float]:
        return {"c": 0.0}

    def default_range(self, parameter: str) -> tuple[float, float] | None:
        return (0.0, 1.5)

    def describe_failure(self, z: np.ndarray) -> str:
        return f"Newton's method failed at c = {z[-1]:.6g}: try a smaller step"


def seed(nodes: int = 12) -> Seed:
    """Where the branch starts: without scattering H = 1."""
    return Seed(Scattering(nodes), np.append(np.ones(nodes), 0.0))
