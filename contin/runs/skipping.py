"""A part of a run file that cannot be carried out costs no other part: it is skipped, with a note that says why."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from contin.continuation.defects import contained, described
from contin.errors import ContinError, InputError


@contextmanager
def skipping(skip: Callable[[str], object], refuse: Callable[[InputError], object] | None = None) -> Iterator[None]:
    """What is inside ends with an error, and `skip` gets it in words, `refuse` also errors of the input; Ctrl-C passes.

    So do not only starts without a solution end, but every error of what is asked for that only computing finds: a
    start that lies outside the range once it is solved for, a saddle without the directions that a connection needs.
    """
    try:
        with contained(skip):
            yield
    except ContinError as error:
        skip(str(error))
        if refuse is not None and isinstance(error, InputError):
            refuse(error)
    except (OSError, MemoryError) as error:
        skip(described(error))
