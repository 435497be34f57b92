"""Who says how far a finer mesh moves a point: all problems but those whose unknowns are the states at one time."""

import importlib
import inspect
import pkgutil

import contin
from contin.continuation.problem import Problem

AT_ONE_TIME = {
    "AugmentedCurve", "LocusProblem", "LargeLocus", "AlgebraicProblem", "EquilibriumProblem", "CycleProblem",
    "LargeProblem",
}  # fmt: skip
UNOPENED = ("contin.kernels", "contin.cli", "contin.plot", "contin.exchange", "contin.notebook")


def descendants(kind):
    for child in kind.__subclasses__():
        yield child
        yield from descendants(child)


def test_problems_on_meshes_and_of_trajectories_are_refined():
    for module in pkgutil.walk_packages(contin.__path__, "contin."):
        if not module.name.startswith(UNOPENED):
            importlib.import_module(module.name)
    own = {
        kind.__name__ for kind in descendants(Problem)
        if kind.__module__.startswith("contin.") and not inspect.isabstract(kind) and kind.refined is Problem.refined
    }  # fmt: skip
    assert own == AT_ONE_TIME
