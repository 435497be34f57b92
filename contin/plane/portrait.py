"""`contin.plane`: everything that XPPAUT's phase plane shows, computed in one call."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.api.searches import reach_of
from contin.errors import InputError
from contin.model.model import Model
from contin.plane.cycles import cycles
from contin.plane.drawing import arrow_places, drawn
from contin.plane.factors import components
from contin.plane.field import PlanarField, TwoStates, planar_field
from contin.plane.flights import Flight, fly
from contin.plane.iterates import iterate
from contin.plane.nullclines import nullcline
from contin.plane.plane_parts import PlaneParts
from contin.plane.rest import Rest, rests
from contin.plane.separatrices import separatrices
from contin.records import Fields, Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CELLS: Final = 240  # along each side, in which nullclines are looked for
CELLS_OF_FUNCTIONS: Final = 120  # ... of Python functions, which are called point by point
OFF: Final = 2.0 / CELLS_OF_FUNCTIONS  # of the window: a nullcline farther from an equilibrium is not drawn there
MARGIN: Final = 0.25  # around what the window must show
FAR: Final = 4.0  # of its sizes: how far the window may grow for what is bounded
BESIDE: Final = 0.01  # of the window: where trajectories that look for cycles begin next to an equilibrium


@dataclass(frozen=True, eq=False, repr=False)
class PhasePlane(PlaneParts):
    """The plane of two states of a flow or map at fixed parameters; all points are (x, y).

    window [[x0, x1], [y0, y1]].  nullclines: of each of the two states, curves (K, 2).  rests: equilibria (fixed
    points) with types.  separatrices: halves of the manifolds of saddles.  cycles: limit cycles that were met.
    trajectories: from the given points.  notes: what is not known, and what is held.
    """

    def plot(self, ax: Axes | None = None, **options: object) -> Figure:
        """A matplotlib figure, or the plane drawn into `ax`.

        options : limits, log, size, legend, title, style (`contin.plot.look.Look`).
        """
        return drawn(self, ax, options)

    def document(self) -> Fields:
        """The plane as plain data."""
        x, y = self.field.names
        return {
            "contin": 1, "kind": "plane", "model": self.field.name, "x": x, "y": y,
            "parameters": self.field.parameters, "held": dict(self.field.held), "window": self.window.tolist(),
            "equilibria": [
                {"values": dict(zip((x, y), r.u.tolist(), strict=True)), "type": r.type, "stability": r.stability,
                 "eigenvalues": [[float(v.real), float(v.imag)] for v in r.eigenvalues]}
                for r in self.rests
            ],
            "nullclines": {n: [c.tolist() for c in curves] for n, curves in zip((x, y), self.nullclines, strict=True)},
            "separatrices": [
                {"of": s.of, "kind": s.kind, "end": s.flight.end, "to": s.flight.rest,
                 "points": s.flight.points.tolist()}
                for s in self.separatrices
            ],
            "cycles": [
                {"period": c.period, "multiplier": c.multiplier, "stable": c.stable, "points": c.points.tolist()}
                for c in self.cycles
            ],
            "trajectories": [{"end": f.end, "to": f.rest, "points": f.points.tolist()} for f in self.trajectories],
            "notes": list(self.notes),
            "field": {
                "title": self.field.title, "map": self.field.is_map, "periods": self.field.periods.tolist(),
                "units": dict(self.field.units), "arrows": self.field.motion(arrow_places(self.window)).tolist(),
            },
        }  # fmt: skip

    def __repr__(self) -> str:
        x, y = self.field.names
        return f"<PhasePlane of {self.field.name!r} in {x} and {y}: {len(self.rests)} equilibria>"

    def _repr_html_(self) -> str:
        from contin.notebook import html

        return html.image(self.plot(), "phase plane") + html.paragraph(str(self))

    def __str__(self) -> str:
        x, y = self.field.names
        lines = [f"phase plane of {self.field.name}: {x} in [{self.window[0, 0]:.6g}, {self.window[0, 1]:.6g}], "
                 f"{y} in [{self.window[1, 0]:.6g}, {self.window[1, 1]:.6g}]"]  # fmt: skip
        lines += [f"  {rest}" for rest in self.rests]
        lines += [
            f"  {'stable' if c.stable else 'unstable'} cycle of period {c.period:.10g}, multiplier {c.multiplier:.6g}"
            for c in self.cycles
        ]
        lines += [f"  {s.kind} manifold of the saddle at ({self._place(s.of)}): {self._end(s.flight)}"
                  for s in self.separatrices]  # fmt: skip
        lines += [f"  from ({f.points[0, 0]:.6g}, {f.points[0, 1]:.6g}): {self._end(f)}" for f in self.trajectories]
        return "\n".join([*lines, *(f"  note: {note}" for note in self.notes)])

    def _place(self, k: int) -> str:
        return ", ".join(f"{v:.6g}" for v in self.rests[k].u)

    def _end(self, flight: Flight) -> str:
        if flight.end == "rest" and flight.rest is not None:
            way = "to" if flight.sense > 0 else "from"
            return f"{way} the {self.rests[flight.rest].type} at ({self._place(flight.rest)})"
        words = {"left": "leaves the window", "cycle": "winds around", "time": "is still on its way"}
        return words.get(flight.end, flight.end)


def plane(
    model: TwoStates, x: str, y: str, parameters: Record | None = None, *, x_range: Sequence[float] | None = None,
    y_range: Sequence[float] | None = None, at: Record | None = None, start: str | Record | None = None,
    points: Iterable[Sequence[float]] = (),
) -> PhasePlane:  # fmt: skip
    """The phase plane of states x and y of a flow or a map.

    x_range, y_range : the window; by default around the equilibria and the start.  at : values of the other states,
    which are held (default: those of the start): then the plane is that of the two equations alone.  points : (x, y)
    from which trajectories are drawn.

    Nullclines are refined to rounding from a grid of 240 x 240 cells; equilibria come from `find_equilibria` in the
    window, and what is smaller than a cell may be missed. Separatrices start on the second-order approximation of the
    manifold, a thousandth of the window from the saddle. Limit cycles are those that trajectories from beside
    equilibria, from the window's border, along separatrices and from `points` come to, forwards or backwards in time.

    Raises InputError.
    """
    field = planar_field(model, x, y, parameters, at, start)
    window = _window(field, x_range, y_range)
    known, notes = rests(field, window)
    if field.held:
        values = ", ".join(f"{name} = {value:.6g}" for name, value in field.held.items())
        notes.append(f"held: {values}; the plane is that of {x} and {y} alone")
    cells = CELLS if isinstance(field.planar, Model) else CELLS_OF_FUNCTIONS
    first, second = (nullcline(functions, window, cells) for functions in components(field))
    curves = first, second
    notes += _unseen(field, known, curves, window)
    given = [_point(one) for one in points]
    if field.is_map:
        flights = tuple(iterate(field, u, window) for u in given)
        return PhasePlane(field, window, curves, tuple(known), (), (), flights, tuple(notes))
    halves = separatrices(field, known, window)
    trajectories = [fly(field, u, 1, window, known) for u in given]
    scouts = _scouts(field, known, window)
    met = cycles(field, [*trajectories, *(half.flight for half in halves), *scouts], window)
    stopped = {f.end for f in (*trajectories, *(h.flight for h in halves))} - {"left", "rest", "cycle", "time"}
    notes += [f"a trajectory stopped: {why}" for why in sorted(stopped)]
    return PhasePlane(
        field,
        window,
        curves,
        tuple(known),
        tuple(halves),
        tuple(met),
        tuple(trajectories),
        tuple(notes),
    )


def _unseen(
    field: PlanarField, known: Sequence[Rest], curves: tuple[tuple[Array, ...], tuple[Array, ...]], window: Array
) -> list[str]:
    """Notes where no drawn nullcline passes an equilibrium."""
    widths, notes = window[:, 1] - window[:, 0], []
    for name, parts in zip(field.names, curves, strict=True):
        points = np.concatenate([*parts, np.full((1, 2), np.inf)])
        for rest in known:
            if np.min(np.max(np.abs(points - rest.u) / widths, axis=1)) > OFF:
                notes.append(
                    f"the nullcline of {name} is not drawn near ({rest.u[0]:.6g}, {rest.u[1]:.6g}): the rate vanishes "
                    "there without a change of sign, or on a curve smaller than a cell of the grid"
                )
    return notes


def _point(given: Sequence[float]) -> Array:
    found = np.asarray(given, dtype=float).ravel()
    if found.shape != (2,) or not np.all(np.isfinite(found)):
        raise InputError(f"points: expected pairs (x, y) of numbers; got {given!r}")
    return found


def _window(field: PlanarField, x_range: Sequence[float] | None, y_range: Sequence[float] | None) -> Array:
    """What is given; an angle's period; else the hull of the start and the equilibria, with a margin."""
    reach = reach_of(field.planar, field.parameters)
    u, _ = field.planar.start_point(None, field.parameters)
    found = np.empty((2, 2))
    for k, (name, given) in enumerate(zip(field.names, (x_range, y_range), strict=True)):
        if given is not None:
            low, high = (float(v) for v in given)
            if not (np.isfinite(low) and np.isfinite(high) and low < high):
                raise InputError(f"the window of {name}: expected low < high; got {low:g} and {high:g}")
            found[k] = low, high
        elif field.periods[k] > 0.0:
            found[k] = -0.5 * field.periods[k], 0.5 * field.periods[k]
        else:
            found[k] = reach[name]
    if x_range is not None and y_range is not None:
        return found
    seen = np.vstack([u, *_places(field, u, found)])
    for k, given in enumerate((x_range, y_range)):
        if given is None and field.periods[k] == 0.0:
            low, high = float(seen[:, k].min()), float(seen[:, k].max())
            size = max(high - low, 0.5 * float(np.abs(found[k]).max()))
            middle = 0.5 * (low + high)
            found[k] = middle - (0.5 + MARGIN) * size, middle + (0.5 + MARGIN) * size
    return found


def _places(field: PlanarField, u: Array, reach: Array) -> Iterator[Array]:
    """What a window must show: the equilibria in reach, and where the start and their neighbourhoods lead to."""
    known, _ = rests(field, reach)
    for rest in known:
        yield rest.u[None]
    if field.is_map:
        yield _settled(iterate(field, u, reach))
        return
    widths = reach[:, 1] - reach[:, 0]
    wide = reach + FAR * np.column_stack([-widths, widths])
    repelling = [rest.u + BESIDE * widths * np.array([1.0, 0.0]) for rest in known if rest.stability == "unstable"]
    for start in (u, *repelling):
        yield _settled(fly(field, start, 1, wide, known))


def _settled(flight: Flight) -> Array:
    """The last turn of a trajectory that stays."""
    return flight.points[len(flight.points) // 2 :] if flight.end in ("cycle", "time") else flight.points[:1]


def _scouts(field: PlanarField, known: Sequence[Rest], window: Array) -> Iterator[Flight]:
    """Trajectories that look for cycles: from beside each equilibrium that repels, and from the window's border."""
    widths = window[:, 1] - window[:, 0]
    for rest in known:
        if rest.stability in ("stable", "unstable", "neutral"):
            for sense in (1, -1) if rest.stability == "neutral" else (1 if rest.stability == "unstable" else -1,):
                yield fly(field, rest.u + BESIDE * widths * np.array([1.0, 0.0]), sense, window, known)
    centre = window.mean(axis=1)
    for side in np.array([[0.5, 0.0], [-0.5, 0.0], [0.0, 0.5], [0.0, -0.5]]):
        for sense in (1, -1):
            yield fly(field, centre + 0.98 * side * widths, sense, window, known)
