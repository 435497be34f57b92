"""In which order curves are followed: those through points of stable states first, those that take long last."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

from contin.continuation.branch import Branch, SpecialPoint
from contin.diagram.orbits import generation
from contin.diagram.phase.curves import Curves
from contin.diagram.phase.deferred import Deferred
from contin.diagram.phase.orbit_curves import passes_near
from contin.special.table import codes, crossings, special_type

MOST: Final = 60  # curves
UNSTABLE: Final = 600  # points of curves of unstable orbits, which do not bound the region of a stable state
CASCADES: Final = 2000  # ... of families born on others: there may be infinitely many, on ever smaller regions
RESONANCES: Final = 3  # points R1, R2 beside which curves of tori are searched for, which takes long
RESONANT: Final = frozenset({"R1", "R2"})


def _followed(kind: str) -> tuple[str, ...]:
    """The types on a kind of branch through which a curve leads."""
    return tuple(code for code in codes(kind) if special_type(code).curves)


def _on_orbits(code: str) -> bool:
    """True for points of codimension two of cycles from which other curves are followed."""
    return code in crossings() and bool(special_type(code).orbits)


@dataclass(eq=False)
class Agenda:
    """From the special points of branches to the curves through them, and to those that cross these."""

    curves: Curves
    cascades: Deferred = field(default_factory=lambda: Deferred(CASCADES))  # families born on others
    unstable: Deferred = field(default_factory=lambda: Deferred(UNSTABLE))  # special points of unstable orbits
    resonances: deque[SpecialPoint] = field(default_factory=deque)  # R1 and R2 that wait for the other curves
    searched: int = 0  # of these
    absorbed: dict[int, Branch] = field(default_factory=dict)  # by id: branches whose points were looked at

    def absorb(self, branches: Sequence[Branch]) -> None:
        """Follow the curves through the special points of branches that are new."""
        new = [b for b in branches if b.image_of is None and id(b) not in self.absorbed]
        self.absorbed |= {id(b): b for b in new}
        self.curves.generations |= {b.name: generation(b.born_at) for b in new}
        self._work(deque(p for b in new for p in b.points if p.type in _followed(b.kind)))

    def finish(self) -> None:
        """Curves of tori, of families that were born on others, and of unstable orbits, as far as the budgets go."""
        self._tori()
        for kind, points in (("orbits born on other families", self.cascades), ("unstable orbits", self.unstable)):
            while (point := points.next()) is not None:
                before = self.curves.spent
                self._work(deque(self.curves.follow(point)))
                self._tori()
                points.used += self.curves.spent - before
            if points.waiting:
                self.curves.notes.add(f"curves of {kind} were followed for {points.most} points; there may be more")
                points.waiting.clear()

    def _work(self, queue: deque[SpecialPoint]) -> None:
        while queue:
            if len(self.curves.loci) >= MOST:
                self.curves.notes.add(f"{MOST} curves were followed; there are more")
                return
            point = queue.popleft()
            age = self.curves.generation(point)
            if self._bounds_nothing_stable(point):
                if point.type not in RESONANT:  # unstable tori take long to find and bound nothing
                    self.unstable.add(age, point)
            elif age > 0:
                self.cascades.add(age, point)
            elif point.type in RESONANT:
                self.resonances.append(point)
            else:
                queue.extend(self.curves.follow(point))

    def _bounds_nothing_stable(self, point: SpecialPoint) -> bool:
        """True for special orbits with unstable multipliers besides the critical ones."""
        if self.curves.is_map or "period" not in point.values:
            return False
        return (point.type in codes("orbit") or _on_orbits(point.type)) and point.values.get("unstable", 0) >= 1

    def _tori(self) -> None:
        """Curves of tori beside R1 and R2, unless they are known by now."""
        curves, places = self.curves, self.curves.places
        while self.resonances:
            point = self.resonances.popleft()
            if not places.holds(point) or passes_near(curves.loci, "NS", places.of(point), places.box):
                continue
            if self.searched >= RESONANCES:
                curves.notes.add(f"curves of NS were searched for beside {RESONANCES} points R1 and R2; there are more")
                self.resonances.clear()
                return
            self.searched += 1
            self._work(deque(curves.follow(point)))
