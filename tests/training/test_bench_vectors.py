"""The bench of vector environments counts steps of each kind."""

import pytest

from flatrig import models
from flatrig.training.bench import vector_speed

pytest.importorskip("stable_baselines3")


def test_every_kind_of_vector_is_timed(monkeypatch):
    monkeypatch.setattr(vector_speed, "SIZES", (1, 2))
    monkeypatch.setattr(vector_speed, "STEPS", 4)
    lines = vector_speed.speed_table(models.make("overhead"), 1)
    labels, ones, twos, beside = (list(column.cells) for column in lines.columns)
    assert len(labels) == 4
    assert all(float(speed) > 0 for speed in (*ones, *twos))
    assert [bool(cell) for cell in beside] == [True, False, True, False]
