"""`contin plane`: the phase plane of two states, as a picture or as a page with a slider over a parameter."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from contin.cli.counting import counted
from contin.cli.interrupt import check
from contin.cli.outputs import CUT_SHORT, DONE, Output, writable, write_all
from contin.cli.run import parse_pairs, parse_sets
from contin.cli.simulate import PICTURES, write_figure, write_json
from contin.cli.terminal import console
from contin.errors import InputError
from contin.model.registry import load
from contin.plane.page import plane_page, planes_along
from contin.plane.portrait import PhasePlane, plane
from contin.records import Fields
from contin.store.atomic import write_text

PAGE = ".html"


def plane_of_model(
    reference: str, x: str, y: str, window: Fields, points: Sequence[str], at: Sequence[str], sets: Sequence[str],
    start: str | None, along: tuple[str, float, float] | None, frames: int, out: Path | None, json: str | None,
    quiet: bool,
) -> int:  # fmt: skip
    """Compute, report, write; exit code 1 where a trajectory could not be followed to an end."""
    endings = (PAGE,) if along else (*PICTURES, PAGE)
    if out is not None and out.suffix not in endings:
        what = "an animation is a page, and ends in" if along else "pictures end in"
        raise InputError(f"--out {out}: {what} {', '.join(endings)}")
    if out is not None and not out.absolute().parent.is_dir():
        raise InputError(f"{out}: there is no folder {out.parent}")
    writable(json, {})
    model = load(reference)
    report = console(sys.stderr if json == "-" else sys.stdout, quiet)
    options: Fields = {
        **window, "at": {k: _held(k, v) for k, v in parse_pairs("--at", at).items()}, "start": start,
        "points": [_pair(text) for text in points],
    }  # fmt: skip
    values = parse_sets(sets)
    if along is None:
        planes, parameter = [plane(model, x, y, values, **options)], None
        target = out or Path(f"{model.name}-plane.png")
    else:
        parameter, low, high = along
        target = out or Path(f"{model.name}-plane.html")
        with counted(f"phase planes of {model.name}", console(sys.stderr, quiet)) as count:

            def watch(done: int, total: int) -> None:
                check()
                count(done, total)

            planes = planes_along(model, x, y, parameter, low, high, frames, values, watch=watch, **options)
    outputs = [Output("plot", partial(_draw, planes, parameter, target))]
    if json is not None:
        documents = [one.document() for one in planes]
        document = documents[0] if along is None else {"contin": 1, "kind": "planes", "planes": documents}
        outputs.append(Output("json", partial(write_json, document, json)))

    def tell() -> None:
        for one in planes if along is None else ():
            report.print(str(one), markup=False, highlight=False)

    whole = not any(note.startswith("a trajectory stopped") for one in planes for note in one.notes)
    return write_all(outputs, report, tell).code(DONE if whole else CUT_SHORT)


def _draw(planes: Sequence[PhasePlane], parameter: str | None, path: Path) -> str:
    if path.suffix == PAGE:
        write_text(path, plane_page(planes, parameter))
    else:
        write_figure(planes[0].plot(), path)
    return str(path)


def _held(name: str, value: object) -> float:
    if isinstance(value, str):
        raise InputError(f"--at {name}={value}: expected a number")
    return float(value)  # type: ignore[arg-type]


def _pair(text: str) -> list[float]:
    try:
        first, second = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"--from {text}: write two numbers, as in --from 0.5,-1") from None
    return [first, second]
