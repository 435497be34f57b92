"""Simulations, sweeps, scans and orbits: what happened, drawn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

from contin.notebook import html
from contin.records import Fields

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from contin.continuation.orbit import Orbit
    from contin.exponents.spectrum import LyapunovSpectrum
    from contin.simulate.run import Simulation
    from contin.simulate.scan.carry_out import Scan
    from contin.simulate.sweep import Sweep


def simulation_page(simulation: Simulation) -> str:
    """Time series beside a phase portrait, and how it ended."""
    drawn = html.image(simulation.plot(), "trajectory") if simulation.model.state_names else ""
    return drawn + html.paragraph(str(simulation))


def sweep_page(sweep: Sweep) -> str:
    """Extrema over the parameter, and what did not settle."""
    unsettled = [outcome for outcome in sweep.outcomes if outcome != "settled"]
    words = f"{len(sweep.outcomes)} runs, {len(unsettled)} of them did not settle" if unsettled else ""
    return html.image(sweep.plot(), f"sweep of {sweep.parameter}") + html.paragraph(words)


def exponents_page(found: LyapunovSpectrum) -> str:
    """The exponents over the parameter, or in words."""
    drawn = html.image(found.plot(), f"Lyapunov exponents over {found.parameter}") if found.parameter else ""
    return drawn + html.paragraph(str(found)) + html.notes(found.notes)


def scan_page(scan: Scan) -> str:
    """The map of classes and their counts."""
    return html.image(scan.plot(), "scan") + html.table(("class", "runs"), scan.counts.items())


def orbit_page(orbit: Orbit) -> str:
    """Time series beside the closed curve, period and multipliers."""
    lines = [(f"{value:.10g}", f"{abs(value):.10g}") for value in orbit.multipliers]
    return (
        html.image(orbit.plot(), "periodic orbit")
        + html.paragraph(f"period {orbit.period:.12g}")
        + html.details("multipliers", html.table(("multiplier", "modulus"), lines))
    )


class Surveyed(Protocol):
    """What a page shows of a survey."""

    @property
    def model(self) -> str: ...
    @property
    def columns(self) -> Fields: ...
    @property
    def rows(self) -> Sequence[Any]: ...
    @property
    def notes(self) -> Sequence[str]: ...
    def plot(self) -> Figure: ...


def survey_page(survey: Surveyed) -> str:
    """The bars, a table in words, notes."""
    columns = survey.columns
    rows = [
        (row.attractor, row.parameter, row.value, row.below.type or row.below.reason, row.below.at,
         row.above.type or row.above.reason, row.above.at)
        for row in survey.rows
    ]  # fmt: skip
    head = ("attractor", "parameter", "value", "below", "at", "above", "at")
    drawn = html.image(survey.plot(), f"survey of {survey.model}") if columns["parameter"] else ""
    return drawn + html.details("table", html.table(head, rows)) + html.notes(survey.notes)
