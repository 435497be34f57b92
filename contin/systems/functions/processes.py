"""A system that lives on several processes: process 0 follows it, the others do their part of what it orders.

An order is the name of one of the methods of `Parts`, which all processes call at the same time: whole vectors are on
process 0, None elsewhere. What goes wrong on any process is told by process 0, so that none waits for another.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Mapping
from typing import Any, Final, Protocol, TypeVar

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.systems.functions.function_problem import FunctionProblem

Values = Mapping[str, float]
Result = TypeVar("Result")
STOP: Final = ""  # the order after which nothing is ordered


class Communicator(Protocol):
    """Of mpi4py, or what does the same."""

    def Get_rank(self) -> int: ...

    def bcast(self, obj: object, root: int = 0) -> Any: ...

    def allgather(self, sendobj: str | None) -> list[str | None]: ...


class Parts(Protocol):
    """What every process does when it is ordered. Vectors (n,) are None on all processes but the first."""

    def residual(self, u: Array | None, p: Values) -> Array | None:
        """F(u, p)."""

    def record(self, u: Array | None, p: Values) -> Values:
        """Columns of branches."""

    def linearise(self, u: Array | None, p: Values, key: int) -> None:
        """Keeps dF/du under a number."""

    def multiply(self, v: Array | None, key: int) -> Array | None:
        """dF/du v."""

    def solve(self, r: Array | None, key: int) -> Array | None:
        """About (dF/du)^-1 r."""

    def release(self, nothing: None, keys: list[int]) -> None:
        """Forgets these."""


class Linearised:
    """A linearisation that the processes keep for as long as this object lives."""

    def __init__(self, key: int, unused: list[int]) -> None:
        self.key = key
        weakref.finalize(self, unused.append, key)


class Distributed:
    """A `FunctionProblem` whose functions are computed by several processes."""

    def __init__(
        self, comm: Communicator, parts: Parts, u0: Array | None, parameters: Values, records: bool, **options: Any
    ) -> None:
        self.comm, self.parts = comm, parts
        self.first = comm.Get_rank() == 0
        self._open = False
        self._unused: list[int] = []
        self._keys = 0
        self._latest: tuple[Array, dict[str, float], Linearised] | None = None
        if u0 is not None:
            record = (lambda u, p: self._order("record", u, dict(p))) if records else None
            self.problem = FunctionProblem(
                self._residual, u0, parameters, self._jacobian, preconditioner=self._preconditioner, record=record,
                **options,
            )  # fmt: skip

    def run(self, work: Callable[[FunctionProblem], Result]) -> Result | None:
        """work(problem) on process 0, which all processes serve until it returns; None on the others.

        Everything that computes belongs into `work`, for example switching at the points of a branch. Call it on all
        processes.
        """
        if not self.first:
            while self._obey(*self.comm.bcast(None)):
                pass
            return None
        self._open = True
        try:
            return work(self.problem)
        finally:
            self._open = False
            self.comm.bcast((STOP, ()))

    def _order(self, name: str, vector: Array | None, *rest: object) -> Any:
        """What process 0 gets when all processes call a method of their parts."""
        if not self._open:
            raise InputError("a distributed function computes inside `run` only: the other processes have left")
        if self._unused and name == "linearise":
            done = self._unused[:]
            del self._unused[: len(done)]
            self._order("release", None, done)
        self.comm.bcast((name, rest))
        return self._done(name, vector, rest)

    def _obey(self, name: str, rest: tuple[object, ...]) -> bool:
        """One order on another process; False where there will be no more."""
        if name == STOP:
            return False
        self._done(name, None, rest)
        return True

    def _done(self, name: str, vector: Array | None, rest: tuple[object, ...]) -> Any:
        trouble: str | None = None
        value = None
        try:
            value = getattr(self.parts, name)(vector, *rest)
        except Exception as error:  # noqa: BLE001 - process 0 raises it, whosever it is
            trouble = f"{type(error).__name__}: {error}"
        told = self.comm.allgather(trouble)
        if self.first:
            for rank, text in enumerate(told):
                if text is not None:
                    raise RuntimeError(f"process {rank} of {len(told)}: {text}")
        return value

    # what the problem is made of --------------------------------------------------------------------------------------

    def _residual(self, u: Array, p: Values) -> Array:
        if np.iscomplexobj(u) or any(isinstance(value, complex) for value in p.values()):
            raise TypeError("distributed functions take real numbers")
        return np.asarray(self._order("residual", u, dict(p)))

    def _at(self, u: Array, p: Values) -> Linearised:
        """The linearisation at a point, made once for its product and its preconditioner."""
        latest = self._latest
        if latest is None or not np.array_equal(latest[0], u) or latest[1] != dict(p):
            self._keys += 1
            made = Linearised(self._keys, self._unused)
            self._order("linearise", u, dict(p), made.key)
            latest = self._latest = np.array(u), dict(p), made
        return latest[2]

    def _jacobian(self, u: Array, p: Values) -> Any:
        from scipy.sparse.linalg import LinearOperator

        made = self._at(u, p)
        return LinearOperator((len(u), len(u)), matvec=lambda v: self._order("multiply", v, made.key), dtype=float)

    def _preconditioner(self, u: Array, p: Values) -> Callable[[Array], Array]:
        made = self._at(u, p)
        return lambda r: np.asarray(self._order("solve", r, made.key))
