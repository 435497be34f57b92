"""A phase diagram in words and numbers, and as plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contin.abi import Vector
from contin.plot.vocabulary import locus_words, style_of
from contin.records import Fields, Record

ROUNDING: Final = 1e-14  # of the values that a number stands beside

if TYPE_CHECKING:
    from contin.diagram.phase.phase_data import PhaseData


def report(diagram: PhaseData) -> str:
    """Curves with their points of codimension two, then regions with their states and neighbours."""
    first, second = diagram.parameters
    (a, b), (c, d) = diagram.box
    lines = [
        f"{len(diagram.loci)} curves and {len(diagram.regions)} regions in {first} from {a:g} to {b:g}, "
        f"{second} from {c:g} to {d:g}"
    ]
    for branch in diagram.loci:
        ends = "; ".join(dict.fromkeys(end.text for end in branch.ends))
        lines += ["", f"{branch.name}: {locus_words(branch.locus)}, {len(branch)} points; {ends}"]
        for p in branch.points:
            where = ", ".join(
                f"{name} = {_shown(p.values[name], high - low):.10g}"
                for name, (low, high) in zip(diagram.parameters, diagram.box, strict=True)
            )
            lines.append(f"  {p.label}  {style_of(p.type).words} at {where}")
    lines.append("")
    lines += region_lines(as_data(diagram))
    if diagram.check.followed or diagram.check.led:
        lines += ["", f"checked: {diagram.check.words}"]
    if diagram.notes:
        lines += ["", "notes:", *(f"  {note}" for note in diagram.notes)]
    return "\n".join(lines)


def region_lines(data: Record) -> list[str]:
    """Each region of a diagram's data: name, states, representative point, size, neighbours; and its stable states."""
    regions = data["regions"]
    names = [f"{region['name']}{region['number'] + 1}" for region in regions]
    lines = []
    for region, name in zip(regions, names, strict=True):
        where = ", ".join(f"{key} = {value:.4g}" for key, value in region["point"].items())
        pairs = [border["regions"] for border in data["borders"]]
        beside = sorted({k for pair in pairs if region["number"] in pair for k in pair} - {region["number"]})
        text = f"region {name}: {region['words']} (at {where}; {region['area']:.1%} of the box"
        lines.append(text + (f"; beside {', '.join(names[k] for k in beside)})" if beside else ")"))
        for state in region["states"]:
            if state["stable"]:
                values = _state_words(state)
                images = {1: "", 2: " and its mirror image"}.get(state["copies"], f" and {state['copies'] - 1} images")
                lines.append(f"  stable: {values}{images}")
    return lines


def _state_words(state: Record) -> str:
    """The values of an equilibrium; of an orbit the period and the ranges of its states and observables."""
    size = max((abs(value) for value in state["values"].values()), default=0.0)
    values = {name: _shown(value, size) for name, value in state["values"].items()}
    if state.get("kind") != "orbit":
        return ", ".join(f"{key} = {value:.4g}" for key, value in values.items())
    names = [key.removesuffix(".min") for key in values if key.endswith(".min")]
    ranges = [f"{name} {values[f'{name}.min']:.4g} to {values[f'{name}.max']:.4g}" for name in names]
    return f"orbit of period {values['period']:.6g}, " + ", ".join(ranges)


def _shown(value: float, size: float) -> float:
    """The value, or zero where it is that but for rounding."""
    return 0.0 if abs(value) < ROUNDING * size else value


def as_data(diagram: PhaseData) -> Fields:
    """See `PhaseData.as_data`."""

    def ring(points: Vector) -> list[list[float]]:
        return [[float(x), float(y)] for x, y in points]

    regions: list[Record] = [
        {
            "name": region.name,
            "number": region.number,
            "words": region.words,
            "stable": region.stable,
            "total": region.total,
            "stable_orbits": region.stable_orbits,
            "orbits": region.orbits,
            "aperiodic": region.aperiodic,
            "point": dict(region.point),
            "states": [
                {
                    "kind": ("equilibrium" if state.orbit is None else "orbit") if state.steps == 1 else "cycle",
                    "values": dict(state.values),
                    "unstable": state.unstable,
                    "stable": state.unstable == 0,
                    "copies": state.copies,
                }
                for state in region.states
            ],
            "area": region.area,
            "outline": ring(region.outline),
            "holes": [ring(hole) for hole in region.holes],
        }
        for region in diagram.regions
    ]
    borders = [{"regions": list(pair), "curves": sorted(curves)} for pair, curves in diagram.borders.items()]
    box = {name: list(bounds) for name, bounds in zip(diagram.parameters, diagram.box, strict=True)}
    curves = [branch.name for branch in diagram.loci]
    check = {
        "followed": diagram.check.followed, "orbits": diagram.check.led, "disagreed": len(diagram.check.disagreed),
    }  # fmt: skip
    return {
        "parameters": list(diagram.parameters), "range": box, "curves": curves, "regions": regions, "borders": borders,
        "check": check,
    }  # fmt: skip
