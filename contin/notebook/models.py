"""Models and derivations: typeset equations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contin.notebook import html

if TYPE_CHECKING:
    from contin.model.model import Model
    from contin.symbolic.averaging.derivation import Derivation

MATH: Final = "tex2jax_process mathjax_process"  # Jupyter typesets every output, Sphinx only what is named so


def model_page(model: Model) -> str:
    """Title, typeset equations, tables of states and parameters."""
    style = f'class="{MATH}" style="overflow-x:auto"'
    typeset = f"<div {style}>$${html.text(model.latex())}$$</div>" if model.states else ""
    return (
        f"<b>{html.text(model.title or model.name)}</b>"
        + typeset
        + html.details("parameters", html.values(model.default_parameters()))
        + html.details("model file", f"<pre>{html.text(model.text())}</pre>")
    )


def derivation_page(derivation: Derivation) -> str:
    """The averaged equations, the steps folded."""
    return model_page(derivation.model) + html.details(derivation.title, f"<pre>{html.text(derivation.text())}</pre>")
