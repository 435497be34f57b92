"""Estimated errors that are computed when first read: they take longer than the coefficients they belong to."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping


class Later(Mapping[str, float]):
    """Numbers by name from a function that is called once, at the first look; equal to the dictionary that it gives.

    Only for what decides nothing: errors that say whether a coefficient has a sign are computed with it. Copies and
    pickles are plain dictionaries.
    """

    def __init__(self, compute: Callable[[], Mapping[str, float]]) -> None:
        self._compute: Callable[[], Mapping[str, float]] | None = compute
        self._known: dict[str, float] = {}

    def _numbers(self) -> dict[str, float]:
        compute = self._compute
        if compute is not None:
            self._known = dict(compute())
            self._compute = None
        return self._known

    def __getitem__(self, name: str) -> float:
        return self._numbers()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._numbers())

    def __len__(self) -> int:
        return len(self._numbers())

    def __repr__(self) -> str:
        return repr(self._numbers())

    def __reduce__(self) -> tuple[type[dict[str, float]], tuple[dict[str, float]]]:
        return dict, (self._numbers(),)


def stated(errors: Mapping[str, float]) -> Mapping[str, float]:
    """Errors as a label carries them: a dictionary of its own, or those that are computed when they are read."""
    return errors if isinstance(errors, Later) else dict(errors)
