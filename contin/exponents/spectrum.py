"""Lyapunov exponents with their errors, one row for each value of a parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contin import lazy
from contin.abi import Array
from contin.records import Fields

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class LyapunovSpectrum:
    """Exponents (N, k), from large to small, in units of 1/time (of a map: an iterate), and their errors (N, k).

    parameter, values : what was stepped, and its values (N,); "" and empty of one trajectory alone (N = 1).
    times : (N,) that the means are taken over.  outcomes : done, or why a trajectory ended early, in words; its
    exponents are nan.  complete : all exponents, or the k largest alone.  notes : what to know about single rows.
    """

    model: Any
    parameter: str
    values: Array
    rows: Array
    row_errors: Array
    times: Array
    outcomes: tuple[str, ...]
    complete: bool
    notes: tuple[str, ...] = ()

    @property
    def exponents(self) -> Array:
        """(k,) of one trajectory; (N, k) along a parameter."""
        return self.rows if self.parameter else self.rows[0]

    @property
    def errors(self) -> Array:
        """Of the exponents, at 95 %; inf where the time is too short to tell."""
        return self.row_errors if self.parameter else self.row_errors[0]

    @property
    def dimension(self) -> Any:
        """Kaplan-Yorke dimension j + (lambda_1 + ... + lambda_j)/|lambda_j+1|; (N,) along a parameter.

        nan where more exponents than were asked for decide it.
        """
        found = np.array(self._dimensions)
        return found if self.parameter else float(found[0])

    @property
    def _dimensions(self) -> list[float]:
        """Exponents within their errors of zero count as zero."""
        rows = np.where(np.abs(self.rows) <= self.row_errors, 0.0, self.rows)
        return [kaplan_yorke(np.sort(row)[::-1], self.complete) for row in rows]

    @property
    def signs(self) -> list[str]:
        """Of each row, as papers write them: "+ 0 -" for a strange attractor of three states. 0: within its error."""
        rows = zip(self.rows, self.row_errors, strict=True)
        return [" ".join(map(_sign, row.tolist(), errors.tolist())) for row, errors in rows]

    @property
    def columns(self) -> Fields:
        """The parameter, exponent.1, error.1, ..., dimension, time, outcome."""
        columns: Fields = {self.parameter: self.values} if self.parameter else {}
        for k in range(self.rows.shape[1]):
            columns |= {f"exponent.{k + 1}": self.rows[:, k], f"error.{k + 1}": self.row_errors[:, k]}
        return columns | {"dimension": np.array(self._dimensions), "time": self.times, "outcome": list(self.outcomes)}

    def plot(self, *, ax: Axes | None = None, **options: object) -> Figure:
        """A matplotlib figure: the exponents, and their errors as bands, over the parameter.

        ax : draw into these axes instead.  options : limits, log, size, legend, title, style (`contin.draw`).
        """
        module = lazy.module("drawn exponents")
        drawn: Figure = module.drawn(self, ax, options)
        return drawn

    def __repr__(self) -> str:
        return f"<LyapunovSpectrum: {self}>"

    def _repr_html_(self) -> str:
        return str(lazy.module("notebook trajectories").exponents_page(self))

    def __str__(self) -> str:
        if self.parameter:
            done = sum(outcome == "done" for outcome in self.outcomes)
            return f"{len(self.values)} values of {self.parameter}, {done} done"
        if self.outcomes[0] != "done":
            return self.outcomes[0]
        pairs = zip(self.rows[0], self.row_errors[0], strict=True)
        return ", ".join(f"{value:.6g} +- {error:.1g}" for value, error in pairs)


def _sign(value: float, error: float) -> str:
    return "?" if np.isnan(value) else "+" if value > error else "-" if value < -error else "0"


def kaplan_yorke(exponents: Array, complete: bool) -> float:
    """The Kaplan-Yorke dimension of exponents (k,) from large to small; nan where they do not decide it."""
    if np.isnan(exponents).any():
        return float("nan")
    total = 0.0
    for j, value in enumerate(exponents.tolist()):
        if total + value < 0.0:
            return float(j + total / abs(value))
        total += value
    return float(len(exponents)) if complete else float("nan")
