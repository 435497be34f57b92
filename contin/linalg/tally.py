"""How much linear algebra a large system took: factorisations, and applications of factors or of preconditioners."""

from __future__ import annotations

from dataclasses import dataclass

from contin.abi import Vector


@dataclass(eq=False)
class Tally:
    """Counts that grow; what one branch took is the difference of two of them."""

    factorisations: int = 0
    applications: int = 0  # a right-hand side each

    def counts(self) -> dict[str, int]:
        """The counts by name."""
        return {"factorisations": self.factorisations, "applications": self.applications}

    def applied(self, right: Vector) -> None:
        """One more application, or one a column."""
        self.applications += 1 if right.ndim == 1 else right.shape[1]
