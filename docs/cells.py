"""Executes the cells of a page in a fork of the process that builds: no kernel starts, nothing is imported again.

A kernel takes 3 s of a processor to start and to import contin and Matplotlib, and so does nearly each `!contin` of a
cell; a fork has them. What a cell shows is collected in its order as a kernel would send it: text of the cell and of
the processes that it starts, pictures, results, errors. `CONTIN_DOCS_COST=1` tells the processor seconds of each cell.
"""

import base64
import fcntl
import os
import pty
import resource
import runpy
import shlex
import signal
import struct
import sys
import tempfile
import termios
import time
import traceback
from collections.abc import Iterable
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import IO, Any, NoReturn

import matplotlib.pyplot
from IPython.core.displayhook import DisplayHook
from IPython.core.displaypub import DisplayPublisher
from IPython.core.interactiveshell import InteractiveShell
from jupyter_cache.executors.utils import ExecutionResult
from nbclient.exceptions import CellExecutionError, CellTimeoutError
from nbformat import NotebookNode, v4

import contin
from contin import lazy
from contin.cli.main import main
from contin.transitions.registry import everything

SHELL_SIGNS = set("|&;<>()$`*?[#~{%!\n\\")  # a command with one of them is the shell's
ROWS, COLUMNS = 24, 80  # of the terminal in which a kernel carries out `!command`


def load() -> None:
    """What cells import, and the machine code that nearly all of them run: 6 s once, 1.5 s in each fork without it."""
    for name in lazy.MODULES:
        lazy.module(name)
    everything()
    line = contin.continuation(contin.equilibrium(contin.load("brusselator")), "B", (0, 4))
    contin.continuation(line["HB1"].switch(), "B", (0, 4), settings={"steps": 5}).plot()
    matplotlib.pyplot.close("all")


class Shown:
    """What the cell shows: standard output and error of this process and its children, and what is displayed."""

    def __init__(self) -> None:
        self.outputs: list[NotebookNode] = []
        self._files: dict[str, IO[bytes]] = {}
        for name, number in (("stdout", 1), ("stderr", 2)):
            written, path = tempfile.mkstemp()
            os.dup2(written, number)
            self._files[name] = open(path, "rb")  # noqa: SIM115  a position of its own
            os.unlink(path)
            setattr(sys, name, open(number, "w", encoding="utf-8", closefd=False))  # noqa: SIM115

    def drain(self) -> None:
        """What was written since the last look becomes outputs."""
        for name, file in self._files.items():
            getattr(sys, name).flush()
            if text := file.read().decode("utf-8", "replace").replace("\r\n", "\n"):
                self.outputs.append(v4.new_output("stream", name=name, text=text))

    def add(self, kind: str, **content: Any) -> None:
        self.drain()
        self.outputs.append(v4.new_output(kind, **content))

    def taken(self) -> list[NotebookNode]:
        self.drain()
        outputs, self.outputs = self.outputs, []
        return outputs


class Results(DisplayHook):
    """The value of a cell's last line."""

    def write_output_prompt(self) -> None:
        """The number is not shown."""

    def write_format_data(self, format_dict: dict[str, Any], md_dict: dict[str, Any] | None = None) -> None:
        count = self.shell.execution_count
        self.shell.shown.add("execute_result", data=_text(format_dict), metadata=md_dict or {}, execution_count=count)

    def finish_displayhook(self) -> None:
        """No line ends."""


class Displayed(DisplayPublisher):
    """What `display` and figures show."""

    def publish(self, data: dict[str, Any], metadata: dict[str, Any] | None = None, **_: Any) -> None:
        self.shell.shown.add("display_data", data=_text(data), metadata=metadata or {})


class PageShell(InteractiveShell):
    """IPython that collects what is shown, and carries out `!contin ...` in a fork."""

    def __init__(self) -> None:
        self.shown = Shown()
        super().__init__(displayhook_class=Results, display_pub_class=Displayed)
        self.enable_matplotlib("inline")
        self.system = self.system_or_fork

    def init_history(self) -> None:
        """The history of pages is not kept in a file."""
        super().init_history()
        self.history_manager.enabled = False

    def enable_gui(self, gui: str | None = None) -> None:
        """No windows."""

    def _showtraceback(self, etype: type[BaseException], evalue: BaseException, stb: list[str]) -> None:
        self.shown.add("error", ename=etype.__name__, evalue=str(evalue), traceback=stb)

    def system_or_fork(self, command: str) -> None:
        command = self.var_expand(command, depth=1)
        words = shlex.split(command) if not SHELL_SIGNS & set(command) else []
        if words[:1] != ["contin"] and words[:2] != ["python", "-m"]:
            self.system_piped(command)
            return
        sys.stdout.flush()
        child, terminal = pty.fork()
        if child == 0:
            _carry_out(words)
        fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
        sys.stdout.write(b"".join(_read(terminal)).decode("utf-8", "replace"))
        self.user_ns["_exit_code"] = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        os.close(terminal)


def _carry_out(words: list[str]) -> NoReturn:
    """The command `contin`, or `python -m MODULE`, in the terminal of this fork."""
    sys.stdin, sys.stdout, sys.stderr = (open(number, mode) for number, mode in ((0, "r"), (1, "w"), (2, "w")))  # noqa: SIM115
    code = 1
    try:
        if words[0] == "contin":
            sys.argv = words
            main(words[1:])
        else:
            sys.argv = words[2:]
            runpy.run_module(words[2], run_name="__main__")
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:  # noqa: BLE001  as Python does where nobody catches it
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def _read(descriptor: int) -> Iterable[bytes]:
    while True:
        try:
            read = os.read(descriptor, 65536)
        except OSError:  # Linux: the other end of a terminal is closed
            return
        if not read:
            return
        yield read


def _text(data: dict[str, Any]) -> dict[str, Any]:
    """Pictures as a notebook holds them."""
    return {kind: base64.b64encode(it).decode() if isinstance(it, bytes) else it for kind, it in data.items()}


def _seconds() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def _cells(cells: list[NotebookNode], folder: str, paths: list[str], out: Connection) -> None:
    """Carry out the cells in this process; what they show goes to `out`, up to the first error that is not wanted."""
    os.chdir(folder)
    sys.path[:0] = ["", *paths]
    shell = PageShell.instance()
    for cell in cells:
        before = _seconds()
        done = shell.run_cell(cell.source, store_history=True)
        outputs = shell.shown.taken()
        out.send((outputs, _seconds() - before))
        if not done.success and "raises-exception" not in cell.metadata.get("tags", []):
            return


def execute(nb: NotebookNode, cwd: str, timeout: float, paths: list[str]) -> ExecutionResult:
    """Execute a page in a fork and put what is shown into its cells: in place of jupyter-cache's function."""
    cells = [cell for cell in nb.cells if cell.cell_type == "code" and cell.source.strip()]
    started = time.perf_counter()
    sys.stdout.flush()
    sys.stderr.flush()
    receive, send = Pipe(duplex=False)
    child = os.fork()
    if child == 0:
        try:
            os.setsid()  # with all that the cells start, it can be ended
            receive.close()
            _cells(cells, cwd, paths, send)
        except BaseException:  # noqa: BLE001  told by the process that builds
            send.send(traceback.format_exc())
        finally:
            os._exit(0)
    send.close()
    error = _collect(cells, receive, timeout, child)
    os.waitpid(child, 0)
    nb.metadata["language_info"] = {"name": "python", "pygments_lexer": "ipython3"}
    return ExecutionResult(nb, cwd, time.perf_counter() - started, error, str(error or ""))


def _collect(
    cells: list[NotebookNode], receive: Connection, timeout: float, child: int
) -> CellExecutionError | CellTimeoutError | None:
    """What each cell shows; the error that ends the page."""
    for number, cell in enumerate(cells):
        if not receive.poll(timeout):
            os.killpg(child, signal.SIGKILL)
            return CellTimeoutError.error_from_timeout_and_cell("the cell takes too long", int(timeout), cell)
        try:
            received = receive.recv()
        except EOFError:
            received = "the process of the page ended"
        if isinstance(received, str):
            return CellExecutionError(f"{cell.source}\n{received}", "RuntimeError", received)
        cell.outputs, seconds = received
        cell.execution_count = number + 1
        if os.environ.get("CONTIN_DOCS_COST"):
            sys.stderr.write(f"{seconds:7.2f} s  {cell.source.strip().splitlines()[0][:90]}\n")
        errors = [output for output in cell.outputs if output.output_type == "error"]
        if errors and "raises-exception" not in cell.metadata.get("tags", []):
            return CellExecutionError.from_cell_and_msg(cell, errors[0])
    return None
