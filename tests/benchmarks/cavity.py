"""The lid-driven cavity beside transiflow: its discretisation, its Jacobian and mass matrix, both programs in one run.

    pip install transiflow
    OMP_NUM_THREADS=1 python -m tests.benchmarks.cavity 16 100 4000

transiflow finds the first Hopf point from an estimate of its frequency and stops there; contin follows the branch to
the end of the range, looks at eigenvalues wherever they can be unstable, and verifies what it finds. Processor time of
one core.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import time
from collections import Counter
from typing import Any

import numpy as np
import scipy.sparse as sp

import contin

NAME = "Reynolds Number"
FREQUENCY = 1.0j  # about which transiflow looks for eigenvalues
STEP = 200.0  # its largest one


class Cavity:
    """transiflow's equations, counted, as M u' = F(u, Re): the pressure of one cell and unused values are held at 0."""

    def __init__(self, cells: int) -> None:
        from transiflow.interface.SciPy import Interface

        self.given = Interface(
            {
                "Problem Type": "Lid-driven Cavity", NAME: 1, "Lid Velocity": 1, "Grid Stretching Factor": 1.5,
                "Eigenvalue Solver": {"Target": FREQUENCY, "Tolerance": 1e-9, "Number of Eigenvalues": 5},
            }, cells, cells,
        )  # fmt: skip
        self.calls: Counter[str] = Counter()
        for name in ("rhs", "jacobian", "direct_solve", "eigs"):
            setattr(self.given, name, self._counted(name, getattr(self.given, name)))
        self.mass = self.given.mass_matrix()
        n = self.mass.shape[0]
        kept = np.ones(n)
        kept[self.given.pressure_row] = 0.0
        self._kept, self._fixed = sp.diags(kept), sp.diags(kept - 1.0)
        pattern = self._jacobian(np.random.default_rng(0).normal(size=n), 1.0).tocsr()
        alone = np.diff(pattern.indptr) == 1
        self._unused = np.flatnonzero(alone & (pattern.diagonal() != 0.0))
        self._rates = pattern.diagonal()[self._unused]

    def _counted(self, name: str, function: Any) -> Any:
        def counted(*arguments: Any, **named: Any) -> Any:
            self.calls[name] += 1
            return function(*arguments, **named)

        return counted

    def residual(self, u: np.ndarray, reynolds: float) -> np.ndarray:
        self.given.set_parameter(NAME, reynolds)
        f = np.array(self.given.rhs(self._kept @ u))
        f[self._unused] = self._rates * u[self._unused]
        return f

    def _jacobian(self, u: np.ndarray, reynolds: float) -> sp.csc_matrix:
        self.given.set_parameter(NAME, reynolds)
        matrix = (self._kept @ self.given.jacobian(self._kept @ u) @ self._kept + self._fixed).tocsc()
        matrix.eliminate_zeros()
        return matrix

    def function(self, u: np.ndarray, reynolds: float) -> contin.FunctionProblem:
        """For contin. F = convection + viscosity / Re, so that its slope by Re comes from two values."""
        return contin.FunctionProblem(
            lambda u, p: self.residual(u, p["Re"]), u, {"Re": reynolds}, lambda u, p: self._jacobian(u, p["Re"]),
            parameter_jacobian=lambda u, p, _: -2.0 * (self.residual(u, 1.0) - self.residual(u, 2.0)) / p["Re"] ** 2,
            mass=self.mass, record=lambda u, p: {"largest": float(np.abs(u).max())}, name="cavity",
        )  # fmt: skip


def by_transiflow(cavity: Cavity, first: float, last: float) -> tuple[np.ndarray, tuple[float, float]]:
    """The state at the first Reynolds number, and the Hopf point that is found from there."""
    from transiflow import Continuation

    with contextlib.redirect_stdout(io.StringIO()):
        given = cavity.given
        given.set_parameter("Lid Velocity", 0)
        u = Continuation(given).continuation(given.vector(), "Lid Velocity", 0, 1, 1)[0]
        u, reynolds = Continuation(given).continuation(u, NAME, 1, first, 100)
        start = u.copy()
        cavity.calls.clear()
        began = time.process_time()
        finer = Continuation(given, newton_tolerance=1e-12)
        _, found = finer.continuation(u, NAME, reynolds, last, 100, ds_max=STEP, detect_bifurcations=True)
        spent = time.process_time() - began
    return start, (found, spent)


def main() -> None:
    """Both, one after the other."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name, kind in (("cells", int), ("first", float), ("last", float)):
        parser.add_argument(name, type=kind)
    asked = parser.parse_args()
    cavity = Cavity(asked.cells)
    start, (found, spent) = by_transiflow(cavity, asked.first, asked.last)
    print(f"transiflow: Hopf point at Re = {found:.6f}, {spent:.1f} s, {dict(cavity.calls)}", flush=True)
    cavity.calls.clear()
    began = time.process_time()
    rest = contin.equilibrium(cavity.function(start, asked.first))
    line = contin.continuation(rest, "Re", (asked.first, asked.last))
    spent = time.process_time() - began
    print(f"contin: {len(line)} rows to Re = {line.columns['Re'][-1]:.0f}, {spent:.1f} s, {dict(cavity.calls)}")
    print(line.effort, *line.notes)
    for point in line.points:
        print(point.label, point.values["Re"], "+-", point.error, dict(point.normal_form))


if __name__ == "__main__":
    main()
