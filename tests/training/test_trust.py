"""What a policy is trusted with: only the plant that it was trained on, and only finite numbers."""

import math
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import pytest

from flatrig import envs, models
from flatrig.models import OptionError, Rig, fingerprint
from flatrig.models.rig.parts import Rope
from flatrig.training.cli import main
from flatrig.training.learned import LearnedResidual, base_controller, check
from flatrig.training.policy import SHIPPED, Policy, shipped

from .test_policy import random_policy

RIG = models.overhead_crane()


def test_equal_rigs_have_one_fingerprint_however_they_came_about(tmp_path: Path) -> None:
    expected = fingerprint(RIG)
    text = models.dumps(RIG).replace("100.0", "1e2")
    assert "1e2" in text
    (tmp_path / "other_name.toml").write_text("# a comment\n" + text)
    upside_down = dict(reversed(list(RIG.home.items())))
    for same in (
        models.overhead_crane(load_mass=100),
        models.load(tmp_path / "other_name.toml")[0],
        replace(RIG, name="renamed"),
        replace(RIG, home=upside_down, masses=RIG.masses[::-1]),
        replace(RIG, gravity=math.nextafter(9.81, 10.0)),
    ):
        assert fingerprint(same) == expected
    assert len(expected) == 64


def changed(rig: Rig) -> list[Rig]:
    """The overhead crane with one thing changed, whatever it may be."""
    rope, drive = rig.ropes[0], rig.drives[0]
    return [
        models.overhead_crane(load_mass=100.001),
        models.overhead_crane(trolley_mass=11.0),
        replace(rig, gravity=9.8),
        replace(rig, outputs=rig.outputs[::-1]),
        replace(rig, drives=rig.drives[::-1]),
        replace(rig, drives=(replace(drive, limit=2.0 * drive.limit), *rig.drives[1:])),
        replace(rig, ropes=(replace(rope, falls=2),)),
        replace(rig, ropes=(replace(rope, drum_radius=0.2),)),
        replace(rig, home={"trolley": 0.0, "load": (0.0, 0.0, -3.9)}),
        replace(rig, rails=(replace(rig.rails[0], end=7.5),)),
        replace(rig, anchors=(models.Anchor("spare", (0.0, 0.0, 0.0)),)),
    ]


def test_every_change_changes_it() -> None:
    prints = {fingerprint(rig) for rig in (RIG, *changed(RIG))}
    assert len(prints) == 1 + len(changed(RIG))
    catalogue = [models.make(name) for name in models.CATALOGUE]
    assert len({fingerprint(rig) for rig in catalogue}) == len(catalogue)


def test_a_field_that_is_added_with_a_default_changes_nothing() -> None:
    """The rope of the first version had no falls: a description without them is the same."""
    falls = next(item for item in fields(Rope) if item.name == "falls")
    assert falls.default == RIG.ropes[0].falls == 1
    table = models.dumps(RIG).replace("falls = 1\n", "")
    assert "falls" not in table
    assert fingerprint(models.loads(table)[0]) == fingerprint(RIG)


@pytest.mark.parametrize("path", sorted(SHIPPED.glob("*crane*.json")), ids=lambda path: path.stem)
def test_shipped_policies_are_for_the_catalogue_s_numbers(path: Path) -> None:
    policy = Policy.load(path)
    card = policy.card
    rig = models.make(card.plant)
    assert path.stem == f"{card.plant}-{card.sensors}"
    assert card.fingerprint == fingerprint(rig)
    assert sum(p.stat().st_size for p in (path, path.with_suffix(".safetensors"))) < 300_000
    options: dict[str, Any] = {"rate": card.rate, "sensors": card.sensors}
    env = base_controller(envs.CraneEnv(rig, disturbances="standard", **options))
    LearnedResidual(env)  # other masses, friction and wind are no other rig
    other = replace(rig, drives=tuple(replace(d, limit=1.5 * d.limit) for d in rig.drives))
    assert shipped(other, card.sensors) is None
    with pytest.raises(OptionError, match="with other parts or numbers than the environment's"):
        check(card, envs.CraneTask(other, reference=models.default_move(rig), **options))


def test_compare_leaves_the_policy_of_another_crane_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    common = ["compare", "overhead", "--nominal", "--set", "load_mass=101"]
    common += ["--goal", "1", "-3.5", "--duration", "2", "-o", str(tmp_path / "out")]
    assert main(common) == 0
    out = capsys.readouterr().out
    assert "no policy is shipped for overhead_crane with these numbers" in " ".join(out.split())
    random_policy().save(tmp_path / "policy")
    assert main([*common, "--policy", str(tmp_path / "policy.json")]) == 2
    assert "with other parts or numbers" in capsys.readouterr().err
