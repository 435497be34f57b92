"""What a continuation returns: a `Branch` of rows, its labelled points, and why each of its two ends is where it is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contin import lazy
from contin.abi import Array, Vector
from contin.continuation.dataframes import dataframe, dataset
from contin.continuation.fields import Fields, fields_of
from contin.continuation.orbit import Orbit, orbit_of
from contin.errors import InputError
from contin.records import Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from pandas import DataFrame
    from xarray import Dataset

ANNOUNCED_FAILURES = frozenset({"corrector", "steps", "stopped"})  # reasons that make a run exit with code 1
ERROR_OF = "error of "  # ... a state: the key of its estimated error among the vectors of a point


@dataclass(frozen=True)
class End:
    """Why a branch ends: `reason` is one of FORMATS' codes, `text` the same in words, `data` what belongs to it."""

    reason: str
    text: str
    data: Record = field(default_factory=dict)
    defect: bool = False  # an error that contin did not foresee


@dataclass(frozen=True, eq=False, repr=False)
class SpecialPoint:
    """A labelled, verified point of a branch.

    `z` is the solution (unknowns, then the varying parameters), `tangent` the branch's unit tangent there in the
    problem's metric, `vectors` the null vectors or eigenvectors of the defining system ('q', 'p', ...; complex for HB).
    """

    type: str
    label: str
    index: int  # row of the branch
    z: Array
    tangent: Array
    values: Mapping[str, float]  # every column and every model parameter at the point
    residual: float  # of the defining system
    error: float  # estimated error of the (first) varying parameter
    eigenvalues: NDArray[np.complex128]
    normal_form: Record
    vectors: Record = field(default_factory=dict)
    also: tuple[str, ...] = ()  # degeneracies that coincide with it, e.g. ('ZH',)
    branch: str = ""
    scale: Array = field(default_factory=lambda: np.empty(0))  # the metric in which it was found
    problem: Any = None

    def __repr__(self) -> str:
        shown = ", ".join(f"{name} = {self.values[name]:.10g}" for name in getattr(self.problem, "parameters", ()))
        return f"<{self.type} {self.branch}.{self.label}{' at ' if shown else ''}{shown}>"

    def switch(self, parameter: str | None = None) -> Any:
        """Where the branches that cross here start: hand it to `contin.continuation`."""
        seeds: list[Any] = lazy.module("births").switch(self.problem, self, parameter or self.problem.parameters[0])
        return seeds

    @property
    def errors(self) -> dict[str, float]:
        """Estimated errors by name: of the first varying parameter, the second one and the states where known."""
        names = tuple(getattr(self.problem, "parameters", ()))
        known = (self.error, self.vectors.get("second"))
        own = {name: float(error) for name, error in zip(names, known, strict=False) if error is not None}
        states = {key: float(error) for key, error in self.vectors.items() if key.startswith(ERROR_OF)}
        return own | {key.removeprefix(ERROR_OF): error for key, error in states.items()}

    @property
    def orbit(self) -> Orbit:
        """The periodic orbit here: `t`, `columns`, `multipliers`; InputError where the point is no orbit."""
        return orbit_of(self.problem, self.z, self.eigenvalues, f"{self.branch}.{self.label}")

    @property
    def fields(self) -> Fields:
        """Of a model of kind: pde, the coordinates and the fields on them; InputError where the point has none."""
        return fields_of(self.problem, self.z, self.values, f"{self.branch}.{self.label}")

    def _repr_html_(self) -> str:
        return str(lazy.module("notebook branches").point_page(self))

    def locus(self, parameters: Sequence[str] | None = None) -> Any:
        """Where the curves of such points in two parameters start: hand it to `contin.continuation` with the same two.

        At a point of codimension two: the other curves through it (its own, where there is no other).
        """
        return LocusStart(self) if parameters is None else lazy.module("births").loci(self.problem, self, parameters)


@dataclass(frozen=True, eq=False)
class LocusStart:
    """A point whose curve in two parameters is wanted; which two is said when it is continued."""

    point: SpecialPoint


@dataclass(frozen=True, eq=False)
class Parent:
    """The point a branch was born at; its type is not known where the branch was read from a file."""

    branch: str
    label: str
    type: str = ""

    @classmethod
    def of(cls, point: SpecialPoint) -> Parent:
        return cls(point.branch, point.label, point.type)


@dataclass(frozen=True, eq=False)
class ImageOf:
    """A branch that a declared symmetry makes of another; it was not computed."""

    branch: str
    symmetry: str


@dataclass(frozen=True, eq=False, repr=False)
class Branch:
    """One curve of solutions, from the end of its down arm through its start to the end of its up arm.

    `columns` maps names (varying parameters, states, observables, `unstable`, `stable`, ...) to arrays with one entry a
    row; `z` and `tangents` hold the unknowns and unit tangents of the rows; `problem` can continue it.
    """

    name: str
    kind: str  # equilibrium | fixed-point | orbit | bvp | locus
    parameters: tuple[str, ...]
    columns: Mapping[str, Vector]
    points: tuple[SpecialPoint, ...]
    ends: tuple[End, End]
    z: Array
    tangents: Array
    eigenvalues: NDArray[np.complex128]  # (rows, k), multipliers for orbits and maps
    start_row: int
    steps: int
    seconds: float
    effort: Mapping[str, int]  # counted evaluations
    problem: Any
    locus: str | None = None
    parent: Parent | None = None
    image_of: ImageOf | None = None
    notes: tuple[str, ...] = ()
    symmetries: tuple[str, ...] = ()  # declared symmetries that map this branch to another, not computed, one
    born_at: tuple[str, ...] = ()  # in a diagram: types of the points that its ancestors and it were born at
    free: tuple[str, ...] = ()  # parameters that are solved for, under conditions
    unexplained: int = 0  # changes of `unstable` that no label explains, events not told apart; each has its note
    defects: tuple[str, ...] = ()  # those of the notes that tell of errors which contin did not foresee
    jumped: int = 0  # changes of `unstable` without a label where the equations jump, which their notes say
    kept: Mapping[int, Mapping[str, Vector]] = field(default_factory=dict)  # of one from a file: orbits by row
    described: Record | None = None  # of one from a file, which has no problem: its model in words and numbers

    def __len__(self) -> int:
        return len(self.z)

    def __repr__(self) -> str:
        labels = ", ".join(point.label for point in self.points) or "no special points"
        kind = f"curve of {self.locus}" if self.locus else self.kind
        varied = f" in {' and '.join(self.parameters)}" if self.parameters else ""
        return f"<Branch {self.name!r}: {kind}{varied}, {len(self)} points; {labels}>"

    def __getitem__(self, label: str) -> SpecialPoint:
        for point in self.points:
            if point.label == label:
                return point
        known = ", ".join(p.label for p in self.points) or "none"
        raise KeyError(f"branch {self.name!r} has no point {label!r}; its points: {known}")

    def orbit(self, row: int) -> Orbit:
        """The periodic orbit at a row (negative rows count from the last): `t`, `columns`, `multipliers`."""
        if not -len(self) <= row < len(self):
            raise IndexError(f"branch {self.name!r} has rows 0 to {len(self) - 1}; got {row}")
        if self.problem is None:
            return self._stored_orbit(row % len(self))
        return orbit_of(self.problem, self.z[row], self.eigenvalues[row], f"row {row} of {self.name}")

    def _stored_orbit(self, row: int) -> Orbit:
        """Of a branch from a file: at a row that the file keeps, or at that of a label."""
        if row in self.kept:
            columns = dict(self.kept[row])
            return Orbit(columns["t"], columns, self.eigenvalues[row], None)
        for point in self.points:
            if point.index == row:
                return point.orbit
        if self.kind != "orbit":
            raise InputError(f"row {row} of {self.name} is no periodic orbit: {self.name} is a branch of another kind")
        rows = ", ".join(str(one) for one in sorted({*self.kept, *(point.index for point in self.points)})) or "none"
        raise InputError(f"row {row} of {self.name} was read from a file, which keeps orbits at the rows {rows}")

    def fields(self, row: int) -> Fields:
        """Of a model of kind: pde, the coordinates and the fields on them at a row (negative: from the last)."""
        if not -len(self) <= row < len(self):
            raise IndexError(f"branch {self.name!r} has rows 0 to {len(self) - 1}; got {row}")
        here = {name: column[row] for name, column in self.columns.items()}
        return fields_of(self.problem, self.z[row], {**self.problem.constants(), **here}, f"row {row} of {self.name}")

    def plot(self, ax: Axes | None = None, **options: object) -> Figure:
        """A matplotlib figure: solid stable, dashed unstable, special points marked; options: `contin.plot.look.Look`.

        ax : draw into these axes instead.
        """
        picture: Figure = lazy.module("picture of branches").picture_of([self], ax, options)
        return picture

    def _repr_html_(self) -> str:
        return str(lazy.module("notebook branches").branch_page(self))

    def to_dataframe(self) -> DataFrame:
        """A pandas.DataFrame with the columns and `label` ('' where a row has none); needs pandas."""
        return dataframe(self)

    def to_xarray(self) -> Dataset:
        """An xarray.Dataset of the columns over the dimension `row`; needs xarray."""
        return dataset(self)

    @property
    def multiplier_kind(self) -> bool:
        """True where `eigenvalues` are multipliers (orbits and maps)."""
        if self.kind == "locus":
            if self.locus == "EX" and "period" in self.columns:
                return True
            system = getattr(self.problem, "system", None)
            kind = (self.described or {}).get("kind", "flow") if system is None else getattr(system, "kind", "flow")
            return self.locus in ("LPC", "BPC", "PD", "NS", "UZ") or kind == "map"
        return self.kind in ("orbit", "fixed-point")


class BranchesByName:
    """What has `branches`: they come in their order, and by name."""

    branches: Sequence[Branch]

    def __iter__(self) -> Iterator[Branch]:
        return iter(self.branches)

    def __len__(self) -> int:
        return len(self.branches)

    def __getitem__(self, name: str) -> Branch:
        for branch in self.branches:
            if branch.name == name:
                return branch
        known = ", ".join(branch.name for branch in self.branches) or "none"
        raise KeyError(f"no branch {name!r}; branches: {known}")
