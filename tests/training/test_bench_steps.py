"""The bench of steps has a row for every rig, and times things in turns."""

from flatrig.training.bench import step_cost
from flatrig.training.options import Bench


def test_a_row_for_every_rig(monkeypatch, capsys):
    monkeypatch.setattr(step_cost, "ENVIRONMENTS", 2)
    assert step_cost.main(Bench("steps", repetitions=1, rig=("overhead", "navy_2d"))) == 0
    printed = capsys.readouterr().out
    assert printed.index("overhead_crane") < printed.index("navy_crane_2d")


def test_turns_alternate_and_the_shortest_counts():
    called = []

    def timer(name, *times):
        left = iter(times)
        return lambda: called.append(name) or next(left)

    timers = [timer("a", 0.1, 5.0, 3.0), timer("b", 0.2, 4.0, 6.0)]
    assert step_cost.shortest(timers, 2) == [3.0, 4.0]  # the first turn warms up
    assert called == ["a", "b"] * 3
