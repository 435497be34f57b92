"""The periodic orbit, or the solution of a boundary-value problem, at a row of a branch, to be drawn or saved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from contin import lazy
from contin.abi import Array
from contin.errors import InputError

if TYPE_CHECKING:
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


@dataclass(frozen=True, eq=False)
class Orbit:
    """One period of an orbit: times `t` from 0 to the period, every state in `columns` (with `t`), `multipliers`."""

    t: Array
    columns: Mapping[str, Array]
    multipliers: NDArray[np.complex128]

    @property
    def period(self) -> float:
        """The time that the orbit takes (of a boundary-value problem: the length of the interval)."""
        return float(self.t[-1] - self.t[0])

    def plot(self, x: str | None = None, y: str | None = None) -> Figure:
        """Time series beside column y over column x (default: the first two states)."""
        drawn: Figure = lazy.module("drawn trajectories").figure(
            self.columns, [name for name in self.columns if name != "t"], x=x, y=y, closed=True
        )
        return drawn

    def to_dataframe(self) -> DataFrame:
        """A pandas.DataFrame of the columns; needs pandas."""
        from pandas import DataFrame

        return DataFrame(dict(self.columns))

    def _repr_html_(self) -> str:
        return cast("str", lazy.module("notebook trajectories").orbit_page(self))


def orbit_of(problem: object, z: Array, multipliers: NDArray[np.complex128], where: str) -> Orbit:
    """The orbit that the vector z of a problem stands for; InputError where it stands for none."""
    if problem is None:
        raise InputError(f"{where} was read from a file: files keep orbits at labelled points, `branch[label].orbit`")
    profile_of = getattr(problem, "profile", None)
    if profile_of is None:
        raise InputError(f"{where} is no periodic orbit: orbits are at the rows and points of branches of orbits")
    profile: Sampled = profile_of(z)
    t = profile.times * profile.period
    names = problem.system.state_names  # type: ignore[attr-defined]
    if not names:  # a large system
        names = [f"u{k}" for k in range(profile.u.shape[1])]
    return Orbit(t, {"t": t, **dict(zip(names, profile.u.T, strict=True))}, multipliers)
