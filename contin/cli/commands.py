"""What carries out each command: a table of names, so that a command imports only what it needs."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import Final

WORK: Final = {
    "run_file": "contin.cli.run",
    "run_diagram": "contin.cli.run",
    "run_phase": "contin.cli.run",
    "simulate_model": "contin.cli.simulate",
    "plane_of_model": "contin.cli.plane",
    "survey_model": "contin.cli.survey",
    "exponents_of_model": "contin.cli.lyapunov",
    "sweep_model": "contin.cli.sweep",
    "scan_file": "contin.cli.scan",
    "check_file": "contin.cli.check",
    "list_models": "contin.cli.models",
    "plot_file": "contin.cli.plot",
    "import_model": "contin.cli.import_model",
    "export_file": "contin.cli.export",
    "show_orbit": "contin.cli.orbit",
    "write_templates": "contin.cli.new",
    "derive_model": "contin.cli.derive",
    "show_model": "contin.cli.show",
    "kernels": "contin.cli.kernels",
    "print_schema": "contin.cli.schema",
}


def work(name: str) -> Callable[..., int]:
    """The function that does the work of a command; the result is the exit code."""
    function: Callable[..., int] = getattr(imported(WORK[name]), name)
    return function


def imported(module: str) -> ModuleType:
    """A module with many others behind it, imported without looking for garbage meanwhile, nor in it later on: all of
    it stays."""
    if module in sys.modules:
        return sys.modules[module]
    collects = gc.isenabled()
    gc.disable()
    try:
        return import_module(module)
    finally:
        gc.freeze()
        if collects:
            gc.enable()
