"""The one table of modules that are imported when something in them is first asked for, with the reason for each.

A row stands here where an import on top of a file would be a circle (a room is asked for what only a higher one knows)
or would make every start of the program wait for what few runs use. Everything else is imported on top.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any, Final

MODULES: Final = {
    "births": "contin.transitions.births",  # a special point is asked what starts there: only the top floor knows
    "simulated": "contin.cli.simulated",  # files of simulations: integrators, which few runs need
    "printing": "contin.model.printing",  # an expression is printed by what is made of expressions
    "yaml": "contin.model.yaml_loader",  # a model that is unpickled is read again, by what makes models
    "pde": "contin.pde.read",  # a file of kind: pde becomes a large sparse system, which is made with numbers
    "exponents": "contin.exponents.lyapunov",  # few simulations ask for them
    "simulation plan": "contin.runs.simulation_plan",  # the plan of a run has parts that are planned as runs are
    "iterates": "contin.simulate.iterate",  # a map is simulated by other means, with the same result
    "stored points": "contin.store.points",  # files are read more often than followed from: machine code, problems
    "stored starts": "contin.runs.stored_starts",  # a run that starts from a file of results needs all that made them
    "scan": "contin.cli.scan",  # a run file may be one of a scan, which is carried out by other means
    "exchange": "contin.exchange.registry",  # a model's name may be that of a foreign file, whose reader makes a model
    "auto start": "contin.api.auto_start",  # simulates to rest, to a cycle, searches: few starts need that
    "conditions": "contin.api.conditions",  # few runs have conditions
    "columns of orbits": "contin.problems.conditioned.requested_columns",  # families of orbits have them
    "simulations": "contin.runs.simulations",  # few runs simulate; integrators
    "notebook branches": "contin.notebook.branches",  # how a result looks is asked for in notebooks only
    "notebook models": "contin.notebook.models",
    "notebook solutions": "contin.notebook.solutions",
    "notebook trajectories": "contin.notebook.trajectories",
    "stored planes": "contin.plane.stored",  # a file may hold phase planes, which are drawn on the top floor
    "reading": "contin.api.reading",  # results of every kind, with what makes them: few pictures need that
    "picture of branches": "contin.plot.figure",  # a branch draws itself with what is made of branches
    "drawn trajectories": "contin.plot.trajectory",
    "drawn sweeps": "contin.plot.sweep",
    "drawn exponents": "contin.plot.exponents",
    "drawn scans": "contin.plot.scan",
    "boundary": "contin.bvp.from_guess",  # a run of a boundary-value problem starts from a guess of functions
    "responses": "contin.search.forced_responses",  # ... of a forced flow from what a trajectory settles on
    "large equilibria": "contin.search.large_equilibrium",  # few models are large
    "large cycles": "contin.transitions.large_cycles",  # sparse matrices of scipy, 0.2 s: few orbits are large
    "discretisation": "contin.transitions.discretisation",  # neither discretisation of orbits knows the other
}


def module(name: str) -> Any:
    """The module of this name in the table."""
    return import_module(MODULES[name])
