"""Solutions that tell themselves: in a line at the prompt and in lists, with their picture in notebooks."""

from __future__ import annotations

from contin import lazy


class Told:
    """A class with `__str__`; a dataclass says `repr=False`, for its fields are arrays."""

    def __repr__(self) -> str:
        return f"<{self}>"

    def _repr_html_(self) -> str:
        return str(lazy.module("notebook solutions").solution_page(self))
