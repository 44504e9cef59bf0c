"""What a policy is trusted with: only the plant that it was trained on, and only finite numbers."""

import json
import math
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from flatrig import envs, models
from flatrig.models import OptionError, Rig, fingerprint
from flatrig.models.rig.parts import Rope
from flatrig.training.cli import main
from flatrig.training.policy import SHIPPED, Policy, shipped

from .test_policy import CARD, random_policy

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


@pytest.mark.parametrize("path", sorted(SHIPPED.glob("*.json")), ids=lambda path: path.stem)
def test_shipped_policies_are_for_the_catalogue_s_numbers(path: Path) -> None:
    rig = models.make(path.stem)
    policy = Policy.load(path)
    assert policy.card.fingerprint == fingerprint(rig)
    env = envs.CraneEnv(rig, rate=policy.card.rate, disturbances="standard")
    policy.check(env.unwrapped.task)  # other masses, friction and wind are no other rig
    other = replace(rig, drives=tuple(replace(d, limit=1.5 * d.limit) for d in rig.drives))
    assert shipped(other) is None
    with pytest.raises(OptionError, match="with other parts or numbers than the environment's"):
        policy.check(envs.CraneTask(other, rate=policy.card.rate))


def test_compare_leaves_the_policy_of_another_crane_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    common = ["compare", "overhead", "--nominal", "--set", "load_mass=101"]
    common += ["--goal", "1", "-3.5", "--duration", "2", "-o", str(tmp_path)]
    assert main(common) == 0
    out = capsys.readouterr().out
    assert "no policy is shipped for overhead_crane with these numbers" in " ".join(out.split())
    assert main([*common, "--policy", str(SHIPPED / "overhead_crane.json")]) == 2
    assert "with other parts or numbers" in capsys.readouterr().err


def test_a_policy_that_does_not_say_its_rig_is_used_with_a_warning_and_can_be_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    policy = Policy.load(SHIPPED / "overhead_crane")
    replace(policy, card=replace(policy.card, fingerprint="")).save(tmp_path / "old")
    path = str(tmp_path / "old.json")
    command = ["compare", "overhead", "--goal", "1", "-3.5", "--duration", "2", "--nominal"]
    assert main([*command, "--policy", path, "-o", str(tmp_path / "out")]) == 0
    warning = capsys.readouterr().err
    assert warning.startswith(f"warning: policy {path} does not say which numbers the rig had")
    assert len(warning.split("\n\n")[0].splitlines()) == 1
    assert main(["fingerprint", "rotary", "--policy", path]) == 2
    assert "for another rig than rotary_crane, it stays as it is" in capsys.readouterr().err
    assert main(["fingerprint", "overhead", "--policy", path]) == 0
    assert capsys.readouterr().out == f"{fingerprint(RIG)}  overhead_crane\n"
    assert Policy.load(path).card == policy.card
    assert main(["fingerprint", "overhead", "--set", "load_mass=1", "--policy", path]) == 2
    assert Policy.load(path).card == policy.card


@pytest.mark.parametrize(
    ("where", "value", "message"),
    [
        ("weights", np.nan, "not finite"),
        ("weights", np.inf, "not finite"),
        ("biases", -np.inf, "not finite"),
        ("mean", np.nan, "not finite"),
        ("scale", np.inf, "not finite"),
        ("scale", 0.0, "a feature's scale is 0, it must be > 0"),
        ("scale", -1.0, "a feature's scale is -1, it must be > 0"),
        ("weights", 1e308, "so large that its outputs are not finite"),
        ("biases", 1.7e308, None),
    ],
)
def test_numbers_that_make_no_finite_action_are_refused(
    tmp_path: Path, where: str, value: float, message: str | None
) -> None:
    policy = random_policy()
    arrays = getattr(policy, where)
    first = (arrays[0] if isinstance(arrays, tuple) else arrays).copy()
    first[...] = value
    made: object = (first, *arrays[1:]) if isinstance(arrays, tuple) else first
    replace(policy, **{where: made}).save(tmp_path / "policy")
    if message is None:  # large, but every output is finite
        loaded = Policy.load(tmp_path / "policy")
        assert np.isfinite(loaded(np.full((1, 3), 1e300), loaded.start())).all()
        return
    with pytest.raises(OptionError, match=message):
        Policy.load(tmp_path / "policy")


def test_a_fingerprint_is_a_text(tmp_path: Path) -> None:
    random_policy().save(tmp_path / "policy")
    entries = json.loads((tmp_path / "policy.json").read_text()) | {"fingerprint": 5}
    (tmp_path / "policy.json").write_text(json.dumps(entries))
    with pytest.raises(OptionError, match="5 stands where a name must stand"):
        Policy.load(tmp_path / "policy")
    assert CARD.fingerprint == ""
