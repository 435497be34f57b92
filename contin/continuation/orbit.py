"""The periodic orbit, or the solution of a boundary-value problem, at a row of a branch, to be drawn or saved."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from contin import lazy
from contin.abi import Array
from contin.continuation.stored_problem import StoredProblem
from contin.errors import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from pandas import DataFrame


class Sampled(Protocol):
    """What a discretisation says of a solution."""

    period: float

    @property
    def u(self) -> Array:
        """(points, n)"""

    @property
    def times(self) -> Array:
        """(points,), from 0 to 1"""


@dataclass(frozen=True, eq=False, repr=False)
class Orbit:
    """One period of an orbit: times `t` from 0 to the period, every state in `columns` (with `t`), `multipliers`."""

    t: Array
    columns: Mapping[str, Array]
    multipliers: NDArray[np.complex128]
    solve: Callable[[], NDArray[np.complex128]] | None = None  # for the eigenfunctions, when they are asked for

    @cached_property
    def eigenfunctions(self) -> NDArray[np.complex128]:
        """(multipliers, times, n): v(t) with v' = f_u v, v(T) = multiplier v(0), |v(0)| = 1, at `t`.

        The component of v(0) of largest modulus is real and positive. InputError where nothing is known but numbers.
        """
        if self.solve is None:
            raise InputError("eigenfunctions are of periodic orbits of flows with their equations")
        return self.solve()

    def to_csv(self, file: str | Path) -> None:
        """Write the columns with their names in the first line, numbers with all their digits."""
        Path(file).write_text(self.csv(), encoding="utf-8")

    def csv(self) -> str:
        """The columns as lines of text, which `samples:` of a run file reads again."""
        rows = zip(*(np.asarray(column).tolist() for column in self.columns.values()), strict=True)
        return "\n".join([",".join(self.columns), *(",".join(map(repr, row)) for row in rows)]) + "\n"

    @property
    def period(self) -> float:
        """The time that the orbit takes (of a boundary-value problem: the length of the interval)."""
        return float(self.t[-1] - self.t[0])

    def plot(self, x: str | None = None, y: str | None = None, *, ax: Axes | None = None, **options: object) -> Figure:
        """Time series beside column y over column x (default: the first two states).

        ax : draw y over x into these axes instead.  options : limits, log, size, title, style (`contin.draw`).
        """
        names = [name for name in self.columns if name != "t"]
        drawn: Figure = lazy.module("drawn trajectories").drawn(
            self.columns, names, ax, {"x": x, "y": y, **options}, closed=True
        )
        return drawn

    def to_dataframe(self) -> DataFrame:
        """A pandas.DataFrame of the columns; needs pandas."""
        from pandas import DataFrame

        return DataFrame(dict(self.columns))

    def __repr__(self) -> str:
        return f"<Orbit of period {self.period:.10g}: {', '.join(name for name in self.columns if name != 't')}>"

    def _repr_html_(self) -> str:
        return cast("str", lazy.module("notebook trajectories").orbit_page(self))


def orbit_of(problem: object, z: Array, multipliers: NDArray[np.complex128], where: str) -> Orbit:
    """The orbit that the vector z of a problem stands for; InputError where it stands for none."""
    profile_of = getattr(problem, "profile", None)
    if profile_of is None:
        raise InputError(f"{where} is no periodic orbit: orbits are at the rows and points of branches of orbits")
    profile: Sampled = profile_of(z)
    t = profile.times * profile.period
    names = problem.system.state_names  # type: ignore[attr-defined]
    if not names:  # a large system
        names = [f"u{k}" for k in range(profile.u.shape[1])]
    solve = _eigenfunctions(problem, z, multipliers)
    return Orbit(t, {"t": t, **dict(zip(names, profile.u.T, strict=True))}, multipliers, solve)


def _eigenfunctions(
    problem: object, z: Array, multipliers: NDArray[np.complex128]
) -> Callable[[], NDArray[np.complex128]] | None:
    """How they are found: of a point from a file by what it was computed with."""
    if isinstance(problem, StoredProblem):
        if problem.kind != "orbit":
            return None
        return lambda: problem.computed().orbit.eigenfunctions
    found = getattr(problem, "eigenfunctions", None)
    return None if found is None else partial(found, z, multipliers)
