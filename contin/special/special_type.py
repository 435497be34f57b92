"""What a type of special point is: a row of the table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from contin.abi import Array


@dataclass(frozen=True)
class Sign:
    """How a point shows on a curve of equilibria or fixed points.

    test : place of the function that changes sign, among the tests of a sample.
    moved : how many eigenvalues change sides there; where a pair should and none does, it is a neutral saddle.
    """

    test: int
    moved: int


@dataclass(frozen=True, kw_only=True)
class SpecialType:
    """A type of special point. Functions, births and curves are names, so that a row costs no import.

    code : the field's label.  words : singular.  many : plural, where it is not `words` and an s.
    also : other names in the literature and, in parentheses, of other programs.
    codimension : how many parameters it takes to meet one.  on : kinds of branch it is found on, or types of curve.
    condition : its defining condition.  critical : how many eigenvalues (multipliers) may change sides there.
    normal_form : 'module:function' of a jet; `needs` names further arguments of it, `order` the forms of the jet.
    births : leaves of `contin.transitions` that say what starts there.  curves : types of the curves of equilibria or
    fixed points that pass through it (of orbits: with LPC for LP).  continues : kinds of branch of which another one
    starts there.
    cycle : the code of the same point of a cycle.
    modes : of several critical multipliers: the real ones, and how many pairs there are beside them.
    powers : of a point of cycles: by what power of the eigenvector's length each coefficient of the return map grows;
    by what powers of the eigenvectors' lengths, where there are several.
    ratios : of others, which do not depend on that length: the coefficient that they are divided by.
    rate : of coefficients that are stated per unit of time: the sign that those of the return map have beside them.
    branch, points, orbits, connections : where its test function stands among those of a sample: of a branch in one
    parameter; by type of curve of equilibria, and of cycles; on curves of connecting orbits.
    cosine : of the critical angle of a resonance.  flows, maps : which of both have it.
    test, form : of a type that is found by a function of its own, of (problem, z): a number that changes sign there
    (nan where it means nothing), and what is told of the point as its normal form.
    marker, symbol : matplotlib's and the viewer's sign.  colour, dashes : of its curves (an index into the palette, or
    a colour).  quiet : not named in pictures of two parameters.
    """

    code: str
    words: str
    codimension: int
    on: tuple[str, ...]
    condition: str
    marker: str = "o"
    symbol: str = "circle"
    many: str = ""
    also: str = ""
    source: str = ""
    critical: int | None = None
    normal_form: str = ""
    needs: tuple[str, ...] = ()
    order: int = 0
    births: tuple[str, ...] = ()
    curves: tuple[str, ...] = ()
    continues: tuple[str, ...] = ()
    cycle: str = ""
    modes: tuple[tuple[float, ...], int] | None = None
    powers: Mapping[str, int | tuple[int, int]] = field(default_factory=dict)
    ratios: Mapping[str, str] = field(default_factory=dict)
    rate: float = 0.0
    branch: int | None = None
    points: Mapping[str, Sign] = field(default_factory=dict)
    orbits: Mapping[str, int] = field(default_factory=dict)
    connections: int | None = None
    cosine: float | None = None
    flows: bool = True
    maps: bool = False
    colour: int | str | None = None
    dashes: tuple[float, ...] = ()
    quiet: bool = False
    test: Callable[[Any, Array], float] | None = None
    form: Callable[[Any, Array], Mapping[str, Any]] | None = None

    @property
    def plural(self) -> str:
        """What many of them are called."""
        return self.many or f"{self.words}s"
