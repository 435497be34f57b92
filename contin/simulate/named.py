"""What a state is called in words: by its name, or by its number where states have no names."""

from __future__ import annotations

from contin.systems.protocol import System


def name_of_state(system: System, k: int) -> str:
    """Fields have no names, nor have the states of a function whose record measures them."""
    names = system.state_names or getattr(system.model, "measured_names", ())
    return str(names[k]) if names else f"u{k}"
