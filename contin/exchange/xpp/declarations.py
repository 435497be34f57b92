"""What an .ode file declares, before formulas are read."""

from __future__ import annotations

from dataclasses import dataclass, field

from contin.exchange.xpp.options import Options


@dataclass(frozen=True)
class Formula:
    """A formula and the line it stands on; functions have arguments."""

    line: int
    name: str
    text: str
    arguments: tuple[str, ...] = ()


@dataclass(frozen=True)
class Table:
    """Values of a formula in t at equal distances, between which XPP draws straight lines."""

    formula: Formula
    points: int
    low: float
    high: float


@dataclass(frozen=True)
class Reset:
    """Variables that take new values where a formula crosses zero upwards or downwards; all from the values before."""

    direction: str
    when: Formula
    jumps: tuple[Formula, ...]


@dataclass
class Declared:
    """Statements by what they declare, in the order of the file."""

    states: list[Formula] = field(default_factory=list)
    algebraic: list[Formula] = field(default_factory=list)  # 0 = ..., with the names of the variables that solve it
    solved: list[tuple[str, float]] = field(default_factory=list)  # these variables and their guesses
    fixed: list[Formula] = field(default_factory=list)
    derived: list[Formula] = field(default_factory=list)
    functions: list[Formula] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    resets: list[Reset] = field(default_factory=list)
    observed: list[Formula] = field(default_factory=list)
    parameters: dict[str, float] = field(default_factory=dict)  # as they are spelled
    numbers: dict[str, float] = field(default_factory=dict)
    initial: list[tuple[str, float]] = field(default_factory=list)
    noise: dict[str, int] = field(default_factory=dict)  # line of each Wiener variable
    boundary: list[int] = field(default_factory=list)
    sets: dict[str, list[tuple[str, float]]] = field(default_factory=dict)
    options: Options = field(default_factory=Options)
    is_map: bool = False
    notes: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)  # what stands in the way, a sentence each
    lines: dict[str, int] = field(default_factory=dict)  # where each name was declared first
