"""One short branch, so that the kernels of equilibria are there before anything is timed or compared word for word."""

from contin import api
from contin.model.yaml_loader import model_from_mapping

MODEL = {
    "name": "warm-up",  # the Bogdanov-Takens normal form: a fold at p = 0, a Hopf point at p = 1
    "states": {"x": 1.1, "y": 0},
    "parameters": {"p": 1.21, "q": -1},
    "equations": {"x": "y", "y": "q*y + p - x^2 + x*y"},
}


def warm_up():
    start = api.equilibrium(model_from_mapping(MODEL, check=False))
    return api.continuation(start, "p", (-0.5, 1.21), direction="down", settings={"steps": 200})
