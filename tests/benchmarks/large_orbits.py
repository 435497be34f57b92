"""Periodic orbits of large systems: the plate of BifurcationKit's tutorial, and a reaction with many nodes.

    OMP_NUM_THREADS=1 python -m tests.benchmarks.large_orbits landau
    OMP_NUM_THREADS=1 python -m tests.benchmarks.large_orbits brusselator --nodes 50000 --intervals 16 --steps 4

Processor time of one core, factorisations and solves in sets of all intervals (times round the orbit), memory. The
plate's last orbit is compared with an explicit method: how well it returns, and its largest multiplier.
"""

from __future__ import annotations

import argparse
import resource
import time
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import contin
from tests.problems.large_orbits.cycles import GinzburgLandau


def brusselator(nodes: int) -> Any:
    """On an interval of length L with fixed ends: 2 x nodes unknowns."""
    return contin.load({
        "name": "brusselator", "kind": "pde", "domain": {"x": {"from": 0, "to": 1, "points": nodes + 2}},
        "fields": {"u": "A", "v": "B/A"}, "parameters": {"L": 0.4, "A": 2, "B": 5.45, "Du": 0.008, "Dv": 0.004},
        "equations": {"u": "Du/L^2*dxx(u) + A - (B + 1)*u + u^2*v", "v": "Dv/L^2*dxx(v) + B*u - u^2*v"},
        "boundary": {"all": ["u = A", "v = B/A"]}, "observables": {"middle": "u(1/2)"},
    })  # fmt: skip


def followed(
    model: Any, parameter: str, to_hopf: tuple[float, float], span: tuple[float, float], **settings: Any
) -> Any:
    """Orbits from the first Hopf point, with what they cost."""
    begun = time.process_time()
    rest = contin.continuation(model, parameter, to_hopf, settings={"stop_at": ["HB"]})
    hopf = rest["HB1"]
    print(
        f"Hopf point {hopf.values[parameter]:.12g} +- {hopf.error:.1g}  {time.process_time() - begun:.1f} s", flush=True
    )
    begun = time.process_time()
    waves = contin.continuation(hopf.switch(), parameter, span, settings=settings)
    seconds, intervals = time.process_time() - begun, settings["intervals"]
    sets, rounds = (waves.effort[name] / intervals for name in ("factorisations", "applications"))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(f"{len(waves)} rows, {sets:.0f} sets of factors, {rounds:.0f} times round, {seconds:.1f} s, {memory:.2f} GB")
    for point in waves.points:
        print(point.label, f"{point.values[parameter]:.10g} +- {point.error:.1g}, period {point.values['period']:.10g}")
    print([end.reason for end in waves.ends], *waves.notes)
    for name in (parameter, "period", "unstable"):
        print(name, waves.columns[name])
    print("multipliers", waves.eigenvalues[-1][:7])
    return waves


def beside_an_explicit_method(plate: GinzburgLandau, waves: Any, row: int) -> None:
    """DOP853 over a period of one row, of the state and of what the largest multiplier's vector becomes."""
    model, z = plate.model(), waves.z[row]
    p, period, u = {"r": float(z[-1])}, float(z[-2]), waves.problem.beginning(z)
    values, vectors = waves.problem.multipliers(z, exactly=True)
    q = np.real(vectors[:, 0])

    def rate(t: float, x: Any) -> Any:
        state, w = x[: len(u)], x[len(u) :]
        return np.concatenate([model.residual(state, p), model.jacobian(state, p) @ w])

    found = solve_ivp(rate, (0, period), np.concatenate([u, q]), method="DOP853", rtol=1e-10, atol=1e-12, max_step=0.02)
    end, moved = found.y[: len(u), -1], found.y[len(u) :, -1]
    velocity = model.residual(u, p)
    along = q - velocity * (q @ velocity) / (velocity @ velocity)  # q is normal to the flow, and M q but for it
    moved = moved - velocity * (moved @ velocity) / (velocity @ velocity)
    print(
        f"r = {p['r']:.10g}: returns to {np.abs(end - u).max() / np.abs(u).max():.1e} of its size; largest value "
        f"{np.abs(found.y[: len(u)]).max():.8f} ({waves.columns['largest.max'][row]:.8f}); multiplier "
        f"{(moved @ along) / (along @ along):.9f} ({values[0].real:.9f})"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("landau", "brusselator"))
    parser.add_argument("--nodes", type=int, default=50_000)
    parser.add_argument("--intervals", type=int, default=20)
    parser.add_argument("--steps", type=int, default=60)
    chosen = parser.parse_args()
    settings = {"intervals": chosen.intervals, "steps": chosen.steps}
    if chosen.what == "landau":
        plate = GinzburgLandau(41, 21)
        print(f"closed form {plate.hopf:.12g}")
        waves = followed(plate.model(), "r", (0.5, 1.2), (0.9, 1.5), **settings)
        for row in (8, len(waves) - 2):
            beside_an_explicit_method(plate, waves, row)
    else:
        followed(brusselator(chosen.nodes), "L", (0.4, 0.52), (0.4, 1.3), **settings)


if __name__ == "__main__":
    main()
