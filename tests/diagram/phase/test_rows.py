"""Lines that serve many regions: every region once, at a point well inside it."""

import numpy as np
import pytest

from contin.diagram.phase.plane import arrangement
from contin.diagram.phase.rows import common_rows
from contin.linalg.polygons import inside


def upright(x):
    return np.array([[x, 0.0], [x, 1.0]])


def test_strips_side_by_side_need_one_row():
    faces = arrangement([upright(x) for x in (0.2, 0.5, 0.7)]).faces
    (row,) = common_rows(faces)
    assert [k for k, _ in row] == list(range(4))
    assert len({float(point[1]) for _, point in row}) == 1
    for k, point in row:
        x = faces[k].outline[:, 0]
        assert point[0] == pytest.approx(0.5 * (x.min() + x.max()), abs=0.01)


def test_strips_above_one_another_need_a_row_each():
    faces = arrangement([np.array([[0.0, y], [1.0, y]]) for y in (0.3, 0.6)]).faces
    assert sorted(len(row) for row in common_rows(faces)) == [1, 1, 1]


@pytest.mark.parametrize("seed", range(4))
def test_every_region_between_random_lines_is_served_once_at_a_point_inside(seed):
    random = np.random.default_rng(seed)
    lines = [np.column_stack([[0.0, 1.0], random.uniform(0.05, 0.95, 2)]) for _ in range(4)]
    lines += [np.column_stack([random.uniform(0.05, 0.95, 2), [0.0, 1.0]]) for _ in range(4)]
    faces = arrangement(lines).faces
    served = [item for row in common_rows(faces) for item in row]
    assert sorted(k for k, _ in served) == list(range(len(faces)))
    assert all(inside(point[None], [faces[k].outline])[0] for k, point in served)
    assert len(common_rows(faces)) < len(faces)
