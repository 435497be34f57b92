"""A model that is easier to write as a program than as a file: a ring of coupled cubic cells."""

from contin import Model


def model(cells: int = 4) -> Model:
    """x_i' = p x_i - x_i^3 + d (x_(i-1) + x_(i+1) - 2 x_i): the uniform state 0 branches at p = 0."""
    states = {f"x{i}": 0.0 for i in range(cells)}
    equations = {
        f"x{i}": f"p*x{i} - x{i}^3 + d*(x{(i - 1) % cells} + x{(i + 1) % cells} - 2*x{i})" for i in range(cells)
    }
    return Model(
        "ring",
        title="A ring of coupled cubic cells",
        source="sample",
        states=states,
        parameters={"p": {"value": -1, "range": [-1, 0.5]}, "d": 1},
        equations=equations,
        symmetries={"turn": {f"x{i}": f"x{(i + 1) % cells}" for i in range(cells)}},
        expect=[{"label": "BP", "at": {"p": 0}, "run": {"parameter": "p", "range": [-1, 0.5]}}],
    )
