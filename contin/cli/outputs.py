"""What a run leaves: the report and the files. Each is tried, whatever becomes of the others."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contin import lazy
from contin._version import __version__
from contin.cli.drawing import load_matplotlib
from contin.cli.printable import printable
from contin.cli.report import print_report
from contin.continuation.defects import described
from contin.errors import ContinError, InputError
from contin.plot.look import Look
from contin.plot.write import write_picture
from contin.records import Fields, Record
from contin.runs.outputs import make_folder
from contin.store import digest, json_format, sqlite
from contin.store.atomic import write_bytes
from contin.store.json_format import escaped
from contin.store.places import refuse_foreign, same_file
from contin.store.solutions import Solutions

if TYPE_CHECKING:
    from rich.console import Console

    from contin.cli.drawer import Drawer
    from contin.runs.plans import Plan

DONE, CUT_SHORT = 0, 1  # exit codes
DATA: Final = ("save", "json", "csv")  # numbers are on the disk before anything is drawn or printed


def writable(json: str | None, outputs: Mapping[str, Path], read: Iterable[Path] = ()) -> None:
    """An output that cannot be written, or must not be, is found before the computation, not after it.

    read : the files that the run is made of, which no output may overwrite.
    """
    read = list(read)
    if json not in (None, "-"):
        path = Path(str(json)).absolute()
        if path.is_dir():
            raise InputError(f"--json {json}: is a folder; name a file")
        if not path.parent.is_dir():
            raise InputError(f"--json {json}: there is no folder {Path(str(json)).parent}")
        if not path.exists() and not os.access(path.parent, os.W_OK):
            raise InputError(f"--json {json}: the folder {path.parent} may not be written to")
        _spare(f"--json {json}", path, read)
        refuse_foreign(path)
    for kind, path in outputs.items():
        above = next(folder for folder in path.absolute().parents if folder.exists())
        if not above.is_dir():
            raise InputError(f"outputs.{kind}: {above} is a file; {path.name} needs a folder of that name")
        if not os.access(above, os.W_OK):
            raise InputError(f"outputs.{kind}: the folder {above} may not be written to")
        _spare(f"outputs.{kind}", path, read)
        if kind == "json":
            refuse_foreign(path)


def _spare(what: str, path: Path, read: Iterable[Path]) -> None:
    hit = same_file(path, list(read))
    if hit is not None:
        raise InputError(f"{what}: would overwrite {hit}, which this run reads; choose another name")


@dataclass(frozen=True)
class Output:
    """One thing that a run leaves; `write` gives the line that reports it, if there is one."""

    kind: str
    write: Callable[[], str | None]


@dataclass
class Written:
    """What became of the outputs: `troubles` in words, and the kinds that were written."""

    troubles: list[str] = field(default_factory=list)
    kinds: set[str] = field(default_factory=set)

    def write(self, outputs: Iterable[Output], tell: Callable[[str], object]) -> None:
        """Write every one, whatever becomes of the others."""
        for output in outputs:
            try:
                line = output.write()
            except ContinError as error:
                self.add(str(error))
            except OSError as error:
                self.add(f"{error.filename or output.kind}: {error.strerror or error}")
            except Exception as error:  # noqa: BLE001 - a defect in one output must not cost another one
                self.add(f"{output.kind} could not be written: {described(error)}")
            else:
                self.kinds.add(output.kind)
                if line:
                    tell(line)

    def add(self, trouble: str) -> None:
        if trouble not in self.troubles:
            self.troubles.append(trouble)

    def code(self, code: int) -> int:
        """Name what could not be written; the exit code, 1 if there was any such thing."""
        for trouble in self.troubles:
            sys.stderr.write(f"{printable(trouble)}\n")
        return max(code, CUT_SHORT) if self.troubles else code


def write_all(outputs: Iterable[Output], report: Console, tell: Callable[[], object] | None) -> Written:
    """The files with numbers, then the report (`tell`), then the pictures; each is tried."""
    outputs = list(outputs)
    written = Written()
    lines: list[str] = []
    written.write((o for o in outputs if o.kind in DATA), lines.append)
    if tell is not None:
        written.write([Output("the report", partial(_told, tell))], report.print)
    for line in lines:
        report.print(line)
    written.write((o for o in outputs if o.kind not in DATA), report.print)
    return written


def _told(tell: Callable[[], object]) -> None:
    tell()


def outputs_of(
    plan: Plan, document: Record, json: str | None, solutions: Solutions | None = None,
    rows: Mapping[str, Fields] | None = None, drawer: Drawer | None = None,
) -> list[Output]:  # fmt: skip
    """Every file that the run file and the command line ask for; a `drawer` has begun the picture."""
    outputs = [Output(kind, partial(_write, plan, kind, document, solutions, rows, drawer)) for kind in plan.outputs]
    if json is not None:
        outputs.append(Output("json", partial(_write_json, document, json)))
    if plan.simulations or plan.sweep:
        outputs += lazy.module("simulated").simulated_outputs(plan, document)
    return outputs


def report_on(document: Record, report: Console) -> None:
    """Print the report of a run."""
    print_report(document, report)


def json_to_stdout(text: str) -> None:
    """JSON on standard output, with escapes where its encoding does not have the characters."""
    try:
        text.encode(getattr(sys.stdout, "encoding", None) or "utf-8")
    except UnicodeEncodeError:
        text = escaped(text)
    sys.stdout.write(text)
    sys.stdout.flush()


def _write_json(document: Record, json: str) -> None:
    if json == "-":
        json_to_stdout(json_format.dumps(digest.signed(document)))
    else:
        json_format.write(document, Path(json))


def _write(
    plan: Plan, kind: str, document: Record, solutions: Solutions | None, rows: Mapping[str, Fields] | None,
    drawer: Drawer | None,
) -> str:  # fmt: skip
    """One of the run file's `outputs`."""
    path = plan.outputs[kind]
    make_folder(path)
    if kind in ("plot", "html"):
        if kind == "plot" and document.get("sweep"):
            lazy.module("simulated").draw_sweep(plan, document, path)
        elif not document["branches"]:
            return f"{path.name} is not drawn: there is no branch"
        else:
            drawn = drawer.picture() if kind == "plot" and drawer is not None else None
            if drawn is not None:
                write_bytes(path, drawn)
            else:
                if kind == "plot":
                    load_matplotlib()
                write_picture(document, path, Look.of(plan.look), rows)
    elif kind == "save":
        sqlite.save(document, path, provenance(plan), solutions)
    else:
        json_format.write(document, path)
    return f"wrote {os.path.relpath(path)}"


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
