"""Simulations, sweeps, scans and orbits: what happened, drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contin.notebook import html

if TYPE_CHECKING:
    from contin.continuation.orbit import Orbit
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
