"""One HTML file of phase planes along a parameter: pictures inside, a slider, nothing loaded from anywhere."""

from __future__ import annotations

import base64
import html
import io
import json
from collections.abc import Callable, Sequence
from importlib import resources
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.limits import check_count
from contin.plane.field import TwoStates
from contin.plane.portrait import PhasePlane, plane
from contin.plot.house_style import style
from contin.records import Fields, Record

MOST_FRAMES: Final = 200


def planes_along(
    model: TwoStates, x: str, y: str, parameter: str, low: float, high: float, frames: int,
    parameters: Record | None = None, *, watch: Callable[[int, int], None] | None = None, **options: Any,
) -> list[PhasePlane]:  # fmt: skip
    """Planes at equal steps of a parameter, in one window: what the first, the middle and the last one need."""
    check_count("frames", frames, 2, MOST_FRAMES)
    if not (np.isfinite(low) and np.isfinite(high) and low != high):
        raise InputError(f"the parameter {parameter} must have two different ends; got {low:g} and {high:g}")
    values = np.linspace(low, high, frames)
    given = dict(parameters or {})
    made: dict[int, PhasePlane] = {}
    if options.get("x_range") is None or options.get("y_range") is None:
        for k in sorted({0, frames // 2, frames - 1}):
            made[k] = plane(model, x, y, {**given, parameter: float(values[k])}, **options)
        windows = np.array([one.window for one in made.values()])
        options |= {"x_range": _hull(windows[:, 0]), "y_range": _hull(windows[:, 1])}
    found = []
    for k, value in enumerate(values.tolist()):
        found.append(plane(model, x, y, {**given, parameter: value}, **options))
        if watch is not None:
            watch(k + 1, frames)
    return found


def _hull(ends: Array) -> tuple[float, float]:
    return float(ends[:, 0].min()), float(ends[:, 1].max())


def plane_page(planes: Sequence[PhasePlane], parameter: str | None = None) -> str:
    """The page; with several planes a slider over the parameter, which also plays."""
    frames: list[Fields] = []
    for one in planes:
        value = "" if parameter is None else f"{parameter} = {one.field.parameters[parameter]:.6g}"
        frames.append({"name": value, "image": _svg(one, value), "words": str(one)})
    template = resources.files("contin.plane").joinpath("plane.html").read_text(encoding="utf-8")
    text = json.dumps(frames, ensure_ascii=True, separators=(",", ":")).replace("<", "\\u003c")
    return template.replace("{{TITLE}}", html.escape(planes[0].field.title)).replace("{{DATA}}", text)


def _svg(one: PhasePlane, title: str) -> str:
    stream = io.BytesIO()
    figure = one.plot(title=title)
    with style():
        figure.savefig(stream, format="svg", metadata={"Date": None})
    return "data:image/svg+xml;base64," + base64.b64encode(stream.getvalue()).decode()
