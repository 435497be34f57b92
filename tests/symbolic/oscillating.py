"""Models of weakly nonlinear oscillators for the tests, and an independent average: quadrature of the equations."""

import math
from itertools import pairwise

import numpy as np

from contin.model.evaluate import evaluate_all
from contin.model.model import Model
from contin.symbolic.calculus.sampling import sample


def oscillators(*forces, parameters=None, stiffness=1, **more):
    """x_i' = y_i, y_i' = -stiffness x_i + eps * force_i; one oscillator is x, y, several are x1, y1, ..."""
    suffixes = [""] if len(forces) == 1 else [str(i + 1) for i in range(len(forces))]
    equations = {}
    for suffix, force in zip(suffixes, forces, strict=True):
        equations |= {f"x{suffix}": f"y{suffix}", f"y{suffix}": f"-({stiffness})*x{suffix} + eps*({force})"}
    return Model(
        "test",
        states={name: 1.3 if name.startswith("x") else 0 for name in equations},
        parameters={"eps": 0.01, **(parameters or {})},
        equations=equations,
        averaging={
            "small": "eps",
            "oscillators": [{"position": f"x{s}", "velocity": f"y{s}"} for s in suffixes],
        },
        **more,
    )


def mean_motion(model, amplitudes, omega=1.0, cuts=(), **parameters):
    """A_i' in slow time at complex amplitudes A_i, by Gauss quadrature of the equations of motion between `cuts`.

    From A = (x - i y/omega) exp(-i omega t):  A' = exp(-i omega t) (x' - y - i (y' + omega^2 x)/omega).
    """
    eps = 1e-3  # forces of the tests are of first order exactly
    ends = np.unique([0.0, 2 * math.pi, *np.mod(cuts, 2 * math.pi)])
    ends = np.concatenate([np.linspace(a, b, 7)[:-1] for a, b in pairwise(ends)] + [ends[-1:]])
    nodes, weights = np.polynomial.legendre.leggauss(24)
    half = np.diff(ends)[:, None] / 2
    tau = (ends[:-1, None] + half * (nodes + 1)).ravel()
    weights = (half * weights).ravel() / (2 * math.pi)
    env = dict(model.default_parameters({**parameters, "eps": eps}))
    names = model.state_names
    for j, a in enumerate(amplitudes):
        z = a * np.exp(1j * tau)
        env[names[2 * j]], env[names[2 * j + 1]] = z.real, -omega * z.imag
    f = sample(model.equations, env)
    result = []
    for i in range(len(amplitudes)):
        x, y = env[names[2 * i]], env[names[2 * i + 1]]
        rate = np.exp(-1j * tau) * (f[2 * i] - y - 1j * (f[2 * i + 1] + omega**2 * x) / omega) / eps
        result.append(weights @ rate)
    return np.array(result)


def polar_motion(model, averaged, amplitudes, **parameters):
    """(A_i' computed from the polar form, up to the common rotation): (r_i', theta_i' - theta_1')."""
    values = averaged.default_parameters(parameters)
    count = len(amplitudes)
    radii = ["r"] if count == 1 else [f"r{i + 1}" for i in range(count)]
    phases = [n for n in averaged.state_names if n.startswith("psi")]
    env = {**values, **dict(zip(radii, np.abs(amplitudes), strict=True))}
    for j, name in enumerate(phases, start=1):
        env[name] = float(np.angle(amplitudes[j] / amplitudes[0]))
    return np.array(evaluate_all(averaged.equations, env))


def polar_of(amplitudes, motion):
    """The same from complex rates A_i'."""
    growth = np.real(motion * np.conj(amplitudes)) / np.abs(amplitudes)
    turn = np.imag(motion * np.conj(amplitudes)) / np.abs(amplitudes) ** 2
    return np.concatenate([growth, turn[1:] - turn[0]])
