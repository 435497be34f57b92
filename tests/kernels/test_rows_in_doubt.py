"""What is in doubt for one pass over the rows is what the looks at all rows ask about: nothing of theirs is missed."""

from types import SimpleNamespace

import numpy as np
import pytest

from contin.continuation import explained, gone_over, metric
from contin.continuation.sample import Chunk, Stop
from contin.kernels import rows_in_doubt

TRIALS = 300
NOISE = 1e-9


def rows(rng):
    """Of a curve of sines in unknowns of many sizes, mostly smooth; some with a jump. Chunk, raw tangents, scale."""
    n, count = int(rng.integers(1, 5)), int(rng.integers(2, 9))
    s = np.sort(rng.uniform(0.0, rng.choice([0.01, 0.3, 1.0]), count))[:, None]
    size = rng.normal(size=n + 1) * 10.0 ** rng.uniform(-4.0, 1.0, n + 1)
    rate, phase = rng.uniform(0.1, 6.0, n + 1), rng.uniform(0.0, 6.0, n + 1)
    z = rng.normal(size=n + 1) * rng.choice([0, 1, 1], n + 1) + size * np.sin(rate * s + phase)
    if rng.random() < 0.3:
        z[count // 2 :] += rng.normal(size=n + 1) * 10.0 ** rng.uniform(-5.0, -1.0)
    scale, raw = 10.0 ** rng.uniform(-0.3, 0.3, n + 1), size * rate * np.cos(rate * s + phase)
    t = raw / scale / np.linalg.norm(raw / scale, axis=1)[:, None]
    lengths = np.append(0.0, np.linalg.norm(np.diff(z / scale, axis=0), axis=1))
    none, no_tests = np.zeros(count, np.int64), np.zeros((count, 0))
    return Chunk(z, t, no_tests, none, no_tests + 0j, lengths, Stop.LIMIT, 0.1, 0.0, 0, 0), raw, scale


@pytest.fixture
def alone(monkeypatch):
    """The looks without the pass before them."""
    for module, name in ((explained, "are_explained"), (metric, "are_resolved")):
        monkeypatch.setattr(module, name, lambda *_: False)


def looks(rng):
    """Whether nothing is in doubt, and whether a look finds nothing, of each of the three."""
    chunk, raw, scale = rows(rng)
    z, t, count = chunk.z, chunk.tangents, len(chunk)
    angles = np.where(rng.random(len(scale) - 1) < 0.2, 2.0 * np.pi, 0.0)
    before, length = t[0] + rng.normal(size=len(scale)) * 0.1, float(rng.choice([0.0, 1.0]) * chunk.lengths[1])
    sample = SimpleNamespace(tangent=before)
    yield (
        rows_in_doubt.are_explained(z, t, chunk.lengths, scale, before, length, NOISE, True),
        explained.first_unexplained(chunk, sample, length, scale, angles, NOISE, 1e-8, np.abs) is None,
    )
    yield (
        rows_in_doubt.are_resolved(z, t, scale, angles, NOISE),
        metric.unresolved(chunk, scale, angles, NOISE) is None,
    )
    start, sense = (int(rng.integers(0, count - 1)), 1) if rng.random() < 0.5 else (int(rng.integers(1, count)), -1)
    way = np.arange(start, count) if sense > 0 else np.arange(start, -1, -1)
    yield (
        rows_in_doubt.may_none_be_of_two(z, raw, scale, angles, NOISE, start, sense),
        not gone_over._suspicious(z, sense * raw, way, scale, angles, NOISE).any(),
    )


def test_one_pass_over_the_rows_leaves_out_nothing_that_the_looks_find(alone):
    rng = np.random.default_rng(1)
    answers = np.array([[*looks(rng)] for _ in range(TRIALS)])
    clear, nothing = answers[..., 0], answers[..., 1]
    assert not np.any(clear & ~nothing)
    assert (np.mean(nothing & ~clear, axis=0) < 0.03).all()  # angles, which one of the looks leaves out
    assert (nothing.mean(axis=0) > 0.1).all()
    assert (nothing.mean(axis=0) < 0.95).all()


def test_a_smooth_branch_of_many_rows_is_passed_over_once():
    s = np.linspace(0.0, 1.0, 4001)[:, None]
    z = np.hstack([2.0 + np.sin(s), np.cos(s + 0.5), s])
    raw = np.hstack([np.cos(s), -np.sin(s + 0.5), np.ones_like(s)])
    scale, angles = np.ones(3), np.zeros(2)
    lengths = np.append(0.0, np.linalg.norm(np.diff(z, axis=0), axis=1))
    t = raw / np.linalg.norm(raw, axis=1)[:, None]
    assert rows_in_doubt.are_explained(z, t, lengths, scale, t[0], 0.0, NOISE, True)
    assert rows_in_doubt.are_resolved(z, t, scale, angles, NOISE)
    assert rows_in_doubt.may_none_be_of_two(z, raw, scale, angles, NOISE, 0, 1)
    assert rows_in_doubt.may_none_be_of_two(z, raw, scale, angles, NOISE, 4000, -1)
