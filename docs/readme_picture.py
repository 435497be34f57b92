"""The picture of README.md: a neuron at rest and firing. `python docs/readme_picture.py` writes docs/readme.png."""

from pathlib import Path

from matplotlib.figure import Figure

import contin


def draw() -> Figure:
    """States of the Morris-Lecar fibre over the applied current, as on the front page of the documentation."""
    neuron = contin.load("morris-lecar")
    rest = contin.continuation(contin.equilibrium(neuron), "I", (-50, 300), name="rest")
    firing = contin.continuation(rest["HB1"].switch(), "I", (-50, 300), name="firing")
    return contin.draw(rest, firing, x="I", y="V", size=(7, 3.8))


if __name__ == "__main__":
    draw().savefig(Path(__file__).with_name("readme.png"), dpi=110)
