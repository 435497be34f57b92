"""Models and derivations: typeset equations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contin.notebook import html

if TYPE_CHECKING:
    from contin.model.model import Model
    from contin.symbolic.averaging.derivation import Derivation


def model_page(model: Model) -> str:
    """Title, typeset equations, tables of states and parameters."""
    equations = "" if not model.states else f"$${html.text(model.latex())}$$"
    return (
        f"<b>{html.text(model.title or model.name)}</b>"
        + equations
        + html.details("parameters", html.values(model.default_parameters()))
        + html.details("model file", f"<pre>{html.text(model.text())}</pre>")
    )


def derivation_page(derivation: Derivation) -> str:
    """The averaged equations, the steps folded."""
    return model_page(derivation.model) + html.details(derivation.title, f"<pre>{html.text(derivation.text())}</pre>")
