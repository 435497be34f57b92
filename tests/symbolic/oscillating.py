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


def mean_rates(model, point, base, parameters=(), nodes=40, pieces=24):
    """Mean rates in slow time, straight from the equations of motion: complex A_i' of the oscillators, then the rates
    of the states under `slow:` and `rotators:`.

    point : complex amplitude of each position, value of each slow state (a rotator's at t = 0).  base : base frequency.
    Slaved states follow by their definition: the periodic solution of their linear equations, found here from the
    Fourier coefficients of what drives them.
    """
    item, eps = model.averaging, 1e-6
    ends = np.linspace(0, 2 * math.pi, pieces + 1)
    x, w = np.polynomial.legendre.leggauss(nodes)
    tau = (ends[:-1, None] + np.diff(ends)[:, None] / 2 * (x + 1)).ravel()
    weights = np.tile(w / (2 * pieces), pieces)
    env = dict(model.default_parameters({**dict(parameters), item.small: 0.0}))
    env["t"] = tau / base
    for pair in item.oscillators:
        z = point[pair.position] * np.exp(1j * pair.harmonic * tau)
        env[pair.position], env[pair.velocity] = z.real, -pair.harmonic * base * z.imag
    env |= {n: point[n] for n in item.slow} | {r.phase: point[r.phase] + r.harmonic * tau for r in item.rotators}
    env |= _following(model, env, tau, weights, base)
    names = list(model.state_names)
    still = dict(zip(names, sample(model.equations, env), strict=True))
    moving = dict(zip(names, sample(model.equations, {**env, item.small: eps}), strict=True))
    rate = {n: (moving[n] - still[n]) / eps for n in names}
    result = []
    for pair in item.oscillators:
        h = pair.harmonic * base
        unit = np.exp(-1j * pair.harmonic * tau)
        result.append(weights @ (unit * (rate[pair.position] - 1j * rate[pair.velocity] / h)))
    return np.array([*result, *(weights @ np.broadcast_to(rate[n], tau.shape) for n in names_of_slow(model))])


def names_of_slow(model):
    return [*model.averaging.slow, *(r.phase for r in model.averaging.rotators)]


def _following(model, env, tau, weights, base):
    names = model.averaging.slaved
    if not names:
        return {}
    rules = [model.equation_map[n] for n in names]
    zero = dict.fromkeys(names, 0.0)
    drive = np.array([np.broadcast_to(f, tau.shape) for f in sample(rules, {**env, **zero})])
    matrix = np.array([np.array([np.mean(f) for f in sample(rules, {**env, **zero, n: 1.0})]) for n in names]).T
    matrix = matrix - np.mean(drive, axis=1)[:, None]
    found = np.zeros(drive.shape)
    for k in range(-6, 7):
        part = drive @ (weights * np.exp(-1j * k * tau))
        response = np.linalg.solve(1j * k * base * np.eye(len(names)) - matrix, part)
        found = found + np.real(response[:, None] * np.exp(1j * k * tau))
    return dict(zip(names, found, strict=True))


def averaged_rates(model, averaged, point, parameters=()):
    """The same of an averaged model in its cartesian form, or polar form with forcing."""
    values = averaged.default_parameters(dict(parameters))
    pairs = model.averaging.oscillators
    cartesian = "u1" in averaged.state_names
    suffixes = [""] if len(pairs) == 1 else [str(i + 1) for i in range(len(pairs))]
    env = {**values, **{n: point[n] for n in names_of_slow(model)}}
    for i, (pair, s) in enumerate(zip(pairs, suffixes, strict=True)):
        a = point[pair.position]
        env |= {f"u{i + 1}": a.real, f"v{i + 1}": a.imag} if cartesian else {f"r{s}": abs(a), f"psi{s}": np.angle(a)}
    found = dict(zip(averaged.state_names, evaluate_all(averaged.equations, env), strict=True))
    result = []
    for i, (pair, s) in enumerate(zip(pairs, suffixes, strict=True)):
        if cartesian:
            result.append(complex(found[f"u{i + 1}"], found[f"v{i + 1}"]))
        else:
            a = point[pair.position]
            result.append((found[f"r{s}"] + 1j * abs(a) * found[f"psi{s}"]) * a / abs(a))
    return np.array([*result, *(found[n] for n in names_of_slow(model))])
