"""What a run leaves: the report and the files. Each is tried, whatever becomes of the others."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contin._version import __version__
from contin.cli.terminal import forget_output, trouble
from contin.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from contin.runs.plan import Plan


def writable(json: str | None, outputs: Mapping[str, Path]) -> None:
    """An output that cannot be written is found before the computation, not after it."""
    if json not in (None, "-"):
        path = Path(str(json)).absolute()
        if path.is_dir():
            raise InputError(f"--json {json}: is a folder; name a file")
        if not path.parent.is_dir():
            raise InputError(f"--json {json}: there is no folder {Path(str(json)).parent}")
        if not path.exists() and not os.access(path.parent, os.W_OK):
            raise InputError(f"--json {json}: the folder {path.parent} may not be written to")
    for kind, path in outputs.items():
        above = next(folder for folder in path.absolute().parents if folder.exists())
        if not above.is_dir():
            raise InputError(f"outputs.{kind}: {above} is a file; {path.name} needs a folder of that name")
        if not os.access(above, os.W_OK):
            raise InputError(f"outputs.{kind}: the folder {above} may not be written to")


def tell_and_write(plan: Plan, document: Mapping[str, Any], json: str | None, report: Console, quiet: bool) -> None:
    """Report the results and write every file that the run file and the command line ask for.

    Raises InputError with what could not be written, after everything else was.
    """
    troubles: list[str] = []
    tasks: list[Callable[[], None]] = [] if quiet else [lambda: _report(document, report)]
    if json is not None:
        tasks.append(lambda: _write_json(document, json))
    tasks += [partial(_write, plan, kind, document, report) for kind in plan.outputs]
    if plan.simulations or plan.sweep:
        from contin.cli.simulated import writers

        tasks += writers(plan, document, report)
    for task in tasks:
        try:
            task()
        except InputError as error:
            troubles.append(str(error))
        except BrokenPipeError:  # the reader has seen enough
            forget_output()
        except OSError as error:
            troubles.append(trouble(error))
            forget_output()
    if troubles:
        raise InputError("\n".join(dict.fromkeys(troubles)))


def _report(document: Mapping[str, Any], report: Console) -> None:
    from contin.cli.report import print_report

    print_report(document, report)


def _write_json(document: Mapping[str, Any], json: str) -> None:
    from contin.store import json_format

    if json == "-":
        sys.stdout.write(json_format.dumps(document))
        sys.stdout.flush()
    else:
        json_format.write(document, Path(json))


def _write(plan: Plan, kind: str, document: Mapping[str, Any], report: Console) -> None:
    """One of the run file's `outputs`."""
    from contin.runs.outputs import make_folder

    path = plan.outputs[kind]
    make_folder(path)
    if kind in ("plot", "html"):
        from contin.plot.write import write_picture

        if kind == "plot" and document.get("sweep"):
            from contin.cli.simulated import draw_sweep

            draw_sweep(plan, document, path)
        elif not document["branches"]:
            report.print(f"{path.name} is not drawn: there is no branch", style="yellow")
            return
        else:
            write_picture(document, path, x=plan.x, y=plan.y)
    elif kind == "save":
        from contin.store import sqlite

        sqlite.save(document, path, provenance(plan))
    else:
        from contin.store import json_format

        json_format.write(document, path)
    report.print(f"wrote {os.path.relpath(path)}")


def provenance(plan: Plan) -> dict[str, str]:
    """What a result file remembers of its run: the model as a file, the runs and settings, the versions."""
    from importlib.metadata import version

    packages = ("numpy", "scipy", "numba", "llvmlite")
    return {
        "model_text": plan.model.text(),
        "run": repr((sorted(plan.parameters.items()), plan.runs, plan.diagram, plan.phase, *_simulated(plan))),
        "versions": ", ".join([f"contin {__version__}", *(f"{name} {version(name)}" for name in packages)]),
    }


def _simulated(plan: Plan) -> list[str]:
    """What is simulated, without the models, whose text has a place of its own."""
    parts = [*plan.simulations, *([plan.sweep] if plan.sweep else [])]
    return [repr(sorted((key, repr(value)) for key, value in vars(part).items() if key != "model")) for part in parts]
