"""An output: a model as text for Maxima, its equilibria as equations to be solved."""

from contin.exchange.imported import Exported
from contin.model.printing import to_text


def write(model):
    """`[x, y]` and `[f = 0, g = 0]` in symbols; values of parameters are left to the user, and said to be."""
    unknowns = ", ".join(model.state_names)
    equations = ", ".join(f"{to_text(right)} = 0" for right in model.equations)
    text = f"unknowns: [{unknowns}]$\nequations: [{equations}]$\n"
    return Exported(text, (f"values of {', '.join(model.parameter_names)} are not written",))
