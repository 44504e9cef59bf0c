"""What is no argument of a function gets one line, with a suggestion where a name is mistyped."""

from fractions import Fraction

import gymnasium as gym
import pytest

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.models import FlatrigError, RigError

RIG = models.overhead_crane()
HAND = models.two_finger_hand()
PATH = feedforward.rest_to_rest((0.0, -4.0), (1.0, -4.0), duration=2.0, order=4)
NO_RIG = "rig is None, it must be a Rig; models.make(name) makes one"
BUILDERS = [*models.CATALOGUE.entries, *models.HAND_CATALOGUE.entries]


@pytest.mark.parametrize("entry", BUILDERS, ids=lambda entry: entry.name)
def test_every_crane_and_hand_suggests_the_parameter_that_is_meant(entry):
    name = next(key for key, kind in entry.build.__annotations__.items() if kind is float)
    mistyped = name[1:] + name[0]
    suggestion = f"{entry.name} has no parameter {mistyped!r}; did you mean .*{name}"
    catalogue = models.CATALOGUE if entry.name in models.CATALOGUE else models.HAND_CATALOGUE
    for build in (
        lambda **overrides: catalogue.make(entry.name, **overrides),
        entry.build,
        getattr(models, entry.name),
    ):
        with pytest.raises(RigError, match=suggestion):
            build(**{mistyped: 3.0})
    with pytest.raises(RigError, match=rf"{entry.name} takes its numbers by name"):
        entry.build(3.0)
    for wrong in (3j, "3", None, True):
        with pytest.raises(RigError, match=f"{entry.name}: {name} is {wrong!r}, it must be a num"):
            entry.build(**{name: wrong})


def test_a_fraction_is_a_number_for_all():
    assert models.overhead_crane(load_mass=Fraction(7, 2)) == models.overhead_crane(load_mass=3.5)
    radius = Fraction(1, 20)
    assert models.two_finger_hand(radius=radius) == models.two_finger_hand(radius=0.05)


CASES = {
    "load": (lambda: models.load(None), "the file of a rig is None, it must be the name of a file"),
    "loads": (lambda: models.loads(None), "the description of a rig is None, it must be TOML text"),
    "load_move": (lambda: models.load_move(3), "the file of a move is 3, it must be the name of"),
    "dump": (lambda: models.dump(None, RIG), "the file of a rig is None"),
    "dump no rig": (lambda: models.dump("never.toml", None), NO_RIG),
    "dumps no move": (lambda: models.dumps(RIG, 3), "move is 3, it must be a Move"),
    "compile": (lambda: models.compile(None), NO_RIG),
    "compile a hand": (lambda: models.compile(HAND), "rig is Hand(name='two_finger_hand', "),
    "compile option": (
        lambda: models.compile(RIG, timestp=1e-3),
        "models.compile has no option 'timestp'; did you mean timestep?",
    ),
    "compile_hand": (lambda: models.compile_hand(None), "hand is None, it must be a Hand; models"),
    "compile_hand option": (
        lambda: models.compile_hand(HAND, visual=False),
        "models.compile_hand has no option 'visual'; did you mean visuals?",
    ),
    "fingerprint": (lambda: models.fingerprint(None), NO_RIG),
    "make": (lambda: models.make(None), "the name of a rig is None, it must be a name"),
    "make typo": (lambda: models.make("overhaed"), "there is no rig 'overhaed'; did you mean over"),
    "make_hand": (lambda: models.make_hand("two_fingr"), "there is no hand 'two_fingr'; did you"),
    "solve": (lambda: feedforward.solve(None, PATH, [0.0]), NO_RIG),
    "solve a list": (lambda: feedforward.solve([], PATH, [0.0]), "rig is [], it must be a Rig"),
    "analyse": (lambda: feedforward.analyse(None), NO_RIG),
    "check": (lambda: feedforward.check(None, PATH), NO_RIG),
    "shortest": (lambda: feedforward.shortest_duration(None, PATH), NO_RIG),
    "integrate": (lambda: feedforward.integrate(None, PATH, step=0.1), NO_RIG),
    "massless": (lambda: feedforward.massless(None), NO_RIG),
    "bisected": (lambda: feedforward.bisected(None, PATH), NO_RIG),
    "from_move": (lambda: feedforward.from_move(None), "move is None, it must be a Move"),
    "crane option": (
        lambda: gym.make("flatrig/OverheadCrane-v0", disturbence="standard"),
        "an environment has no option 'disturbence'; did you mean disturbances?",
    ),
    "rig option": (
        lambda: gym.make("flatrig/Rig-v0", rig=RIG, time_step=1e-3),
        "an environment has no option 'time_step'; did you mean timestep?",
    ),
    "vector option": (
        lambda: gym.make_vec("flatrig/Rig-v0", num_envs=2, rig=RIG, sensor="full"),
        "an environment has no option 'sensor'; did you mean sensors?",
    ),
    "hand option": (
        lambda: gym.make("flatrig/TwoFingerHand-v0", sensor="full"),
        "an environment has no option 'sensor'; did you mean sensors?",
    ),
    "hand vector option": (
        lambda: gym.make_vec("flatrig/TwoFingerHand-v0", num_envs=2, referense=3),
        "an environment has no option 'referense'; did you mean reference?",
    ),
    "no hand": (lambda: envs.HandEnv(), "an environment needs a hand"),
    "a hand for a rig": (lambda: envs.CraneEnv(HAND), "rig is Hand(name='two_finger_hand', "),
}


@pytest.mark.parametrize(("call", "message"), CASES.values(), ids=CASES)
def test_one_short_line(call, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(FlatrigError) as error:
        call()
    assert str(error.value).startswith(message)
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 200
    assert not list(tmp_path.iterdir())
