"""Phase planes of a damped particle in a double well: one as a picture, and a page with a slider over a parameter."""

import contin
from contin.plane.page import plane_page, planes_along

PARTICLE = contin.Model(
    name="particle",
    title="A damped particle in a double well",
    states={"x": 0.1, "v": 1.0},
    parameters={"mu": 1.0, "d": 0.3},
    equations={"x": "v", "v": "mu*x - x^3 - d*v"},
)

if __name__ == "__main__":
    window = {"x_range": (-2, 2), "y_range": (-1.6, 1.6)}
    plane = contin.plane(PARTICLE, "x", "v", points=[(-1.8, 1.4)], **window)
    print(plane)
    plane.plot().savefig("particle.png")
    with open("particle.html", "w", encoding="utf-8") as page:
        page.write(plane_page(planes_along(PARTICLE, "x", "v", "mu", -1, 1.5, 21, **window), "mu"))
