"""Rig descriptions: what they accept, what they refuse, and TOML."""

import copy
import dataclasses
import math
import pickle

import numpy as np
import pytest

from flatrig import models
from flatrig.feedforward import from_move, solve
from flatrig.models import (
    CATALOGUE,
    Anchor,
    Combination,
    Drive,
    Frame,
    Load,
    Move,
    OutputError,
    PathError,
    Platform,
    Rail,
    RigError,
    Rope,
    Sheave,
    Trolley,
)

OVERHEAD = models.overhead_crane()
SHEAVE = Sheave("trolley", inertia=1.0, radius=1.0)


def change(rig=OVERHEAD, **fields):
    return dataclasses.replace(rig, **fields)


def test_names_and_order_are_the_sources():
    assert OVERHEAD.input_names == ("trolley", "winch")
    assert OVERHEAD.outputs == ("load.x", "load.z")
    rotary = models.rotary_crane()
    assert rotary.input_names == ("bridge", "trolley", "winch")
    assert rotary.coordinate_names[:3] == ("bridge.angle", "trolley.position", "hoist.length")
    assert rotary.rope_names == ("hoist",)


def test_data_sets_of_the_rotary_crane():
    small = models.rotary_crane_small()
    assert small.frames[0].inertia == 19.01
    assert [mass.mass for mass in small.masses] == [53.0, 10.0]
    assert small.ropes[0].inertia_along == pytest.approx(2.0)
    assert models.rotary_crane().ropes[0].inertia_along == pytest.approx(10.0)


def test_rigs_are_values():
    assert models.overhead_crane() == models.overhead_crane()
    assert hash(models.overhead_crane()) == hash(models.overhead_crane())
    assert models.overhead_crane() != models.overhead_crane(load_mass=99.0)
    with pytest.raises(dataclasses.FrozenInstanceError):
        OVERHEAD.gravity = 1.0


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"ropes": (Rope("hoist", ("load",), 0.1, 0.1),)}, "its path has 1 point, it needs 2"),
        ({"ropes": (Rope("hoist", ("load", "load"), 0.1, 0.1),)}, "from 'load' to itself"),
        ({"ropes": (Rope("hoist", ("troley", "load"), 0.1, 0.1),)}, "did you mean trolley"),
        ({"ropes": (Rope("hoist", ("trolley", "load"), 0.0, 0.1),)}, "drum_radius is 0 m"),
        ({"ropes": (Rope("hoist", ("trolley", "load"), 0.1, -1.0),)}, "winch_inertia is -1 kg m2"),
        (
            {"ropes": (Rope("hoist", ("trolley", "load"), 0.1, 1, (Sheave("load", 1, 1),)),)},
            "a sheave names 'load'",
        ),
        (
            {
                "anchors": (Anchor("a", (0, 0, 0)),),
                "ropes": (Rope("hoist", ("a", "trolley", "load"), 1, 1, 2 * (SHEAVE,)),),
            },
            "two sheaves stand at 'trolley'",
        ),
        ({"masses": (Trolley("trolley", 0.0, "beam"), Load("load", 1.0))}, "mass is 0 kg"),
        ({"masses": (Trolley("trolley", 1.0, "beam"), Load("load", 0.0))}, "no load with a mass"),
        ({"masses": (Trolley("trolley", 1.0, "baem"), Load("load", 1.0))}, "did you mean beam"),
        ({"outputs": ("load.x", "load.y")}, "output 'load.y' is not a coordinate; did you mean"),
        ({"outputs": ("load.x", "load.x")}, "output 'load.x' is named twice"),
        ({"outputs": ("load.x",)}, "1 outputs for 2 drives"),
        ({"rails": (Rail("beam", (1.0, 1.0, 0.0)),)}, "it must be a unit vector"),
        ({"rails": (Rail("beam", (0.0, 1.0, 0.0)),)}, "a planar rig lies in the plane y = 0"),
        ({"rails": (Rail("beam", (1.0, 0.0, 0.0), start=3, end=1),)}, "must lie below end"),
        ({"rails": (Rail("trolley", (1.0, 0.0, 0.0)),)}, "the name 'trolley' is used twice"),
        ({"anchors": (Anchor("world", (0.0, 0.0, 0.0)),)}, "taken by the fixed frame"),
        ({"name": "a b"}, "rig: name is 'a b', it must be 1 to 64 letters, digits"),
        ({"frames": (Frame("mast", "turning", 1.0),)}, "a planar rig has no turning frame"),
        ({"frames": (Frame("mast", "rolling", 1.0),)}, "it must be turning or sliding"),
        ({"gravity": 0.0}, "gravity is 0 m/s2, it must be > 0"),
        ({"gravity": math.nan}, "gravity is nan"),
        ({"dimensions": 4}, "dimensions is 4, it must be 2 or 3"),
        ({"home": {"trolley": 0.0}}, "home of load load is missing"),
        ({"home": {"trolley": math.inf, "load": (0, 0, -1)}}, "home of trolley is inf"),
        ({"home": {"load": (0, 0)}}, "home of load has 2 numbers, it needs 3"),
        ({"home": {"load": 3.0}}, "home of load is 3.0, it must be (x, y, z)"),
        ({"home": {"trolley": (1, 2, 3), "load": (0, 0, -4)}}, "it must be a number"),
        ({"home": {"load": (0, 7, -4)}}, "home of load: y is 7, a planar rig lies in the plane"),
        ({"home": {"trolley": 9, "load": (0, 0, -4)}}, "rail beam goes from -2 m to 8 m"),
        ({"home": {"trolley": 2, "load": (2, 0, 0)}}, "trolley and load coincide"),
        ({"home": 3}, "home is 3, it must map names to positions"),
        ({"frames": (Frame("f", "sliding", 1.0, (0, 1, 0)),)}, "a planar rig lies in the plane"),
        ({"masses": (*OVERHEAD.masses, "junk")}, "masses holds 'junk'"),
        ({"ropes": ("hoist",)}, "ropes holds 'hoist', it must be a Rope"),
        ({"drives": ("a", "b")}, "drives holds 'a', it must be a Drive"),
        ({"outputs": (1, 2)}, "outputs is 1, it must be a name"),
        ({"name": 3}, "rig: name is 3, it must be a name"),
        ({"home": {"lod": (0, 0, 0)}}, "did you mean load"),
        (
            {"drives": (Drive("a", "trolley", 1.0), Drive("b", "trolley", 1.0))},
            "two drives act on 'trolley'",
        ),
        (
            {"drives": (Drive("a", "trolley", 0.0), Drive("b", "hoist", 1.0))},
            "limit is 0 N or N m, it must be > 0",
        ),
        ({"drives": (Drive("a", "load", 1.0), Drive("b", "hoist", 1.0))}, "names 'load'"),
    ],
)
def test_validation_names_what_is_wrong(fields, message):
    with pytest.raises(RigError) as error:
        change(**fields)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


MANIPULATOR = models.cable_manipulator()


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"inertia": (1.0, 1.0, 3.0)}, "no moment can exceed the sum of the others"),
        ({"inertia": (1.0, 0.0, 1.0)}, "a principal moment of inertia is 0 kg m2"),
        ({"inertia": (1.0, 1.0)}, "inertia has 2 numbers, it needs 3"),
        ({"mass": 0.0}, "platform platform: mass is 0 kg"),
    ],
)
def test_a_platform_has_mass_and_possible_moments_of_inertia(fields, message):
    platform = Platform("platform", 12.5, (0.75, 0.75, 1.5))
    trolleys = MANIPULATOR.trolleys
    with pytest.raises(RigError) as error:
        change(MANIPULATOR, masses=(*trolleys, dataclasses.replace(platform, **fields)))
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("of", "factors", "message"),
    [
        (("trolley_1.position",), (1, 2), "it needs one factor for each coordinate"),
        ((), (), "it needs one factor for each coordinate"),
        (("platform.alpha",), (1,), "platform.alpha is an angle, it must be a length or position"),
        (("trolley_1.positon",), (1,), "did you mean trolley_1.position"),
        (("trolley_1.position",), (math.inf,), "factors is inf"),
    ],
)
def test_a_combination_sums_what_can_be_summed(of, factors, message):
    with pytest.raises(RigError) as error:
        change(MANIPULATOR, combinations=(Combination("spread", of, factors),))
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: Trolley("t", math.nan, "beam"), "trolley t: mass is nan, it must be finite"),
        (lambda: Trolley("t", "5", "beam"), "trolley t: mass is '5', it must be a number"),
        (lambda: Trolley("t", True, "beam"), "mass is True, it must be a number"),
        (lambda: Load("load", 10**400), "load load: mass is inf"),
        (lambda: Load(3, 1.0), "load: name is 3, it must be a name"),
        (lambda: Rail("beam", (1.0, 0.0)), "rail beam: direction has 2 numbers, it needs 3"),
        (lambda: Rope("hoist", (1, 2), 0.1, 0.1), "rope hoist: path is 1, it must be a name"),
        (lambda: Rope("hoist", "ab", 0.1, 0.1), "rope hoist: path is 'ab', it must be a list"),
        (lambda: Rope("hoist", ("a", "b"), 0.1, 0.1, (3,)), "sheaves holds 3, it must be a Sheave"),
        (lambda: models.overhead_crane(load_mass="heavy"), "load_mass is 'heavy'"),
        (lambda: models.overhead_crane(load_mass=None), "load_mass is None"),
        (lambda: models.make(3), "the name of a rig is 3"),
        (lambda: OVERHEAD.rail("baem"), "there is no rail 'baem'; did you mean beam?"),
        (lambda: models.rotary_crane().frame("brigde"), "did you mean bridge?"),
    ],
)
def test_parts_and_functions_refuse_what_is_not_theirs(build, message):
    with pytest.raises(RigError) as error:
        build()
    assert message in str(error.value)


def test_any_kind_of_real_number_will_do():
    plain = models.overhead_crane(load_mass=80.0)
    assert models.overhead_crane(load_mass=np.int64(80)) == plain
    assert models.overhead_crane(load_mass=np.float32(80)) == plain
    home = {"trolley": np.float64(0.0), "load": np.array([0.0, 0.0, -4.0])}
    assert change(plain, home=home) == plain


def test_home_cannot_be_changed_in_place():
    with pytest.raises(TypeError):
        OVERHEAD.home["load"] = (9.0, 9.0, 9.0)
    assert copy.deepcopy(OVERHEAD) == pickle.loads(pickle.dumps(OVERHEAD)) == OVERHEAD


def test_home_points_are_in_the_world():
    rig = change(
        models.rotary_crane(), home={"bridge": np.pi / 2, "trolley": 3, "load": (0, 3, -1)}
    )
    np.testing.assert_allclose(rig.home_point("trolley"), (0, 3, 0), atol=1e-15)
    assert rig.home_point("load") == (0, 3, -1)


@pytest.mark.parametrize("name", list(CATALOGUE))
def test_drives_have_a_third_to_spare_in_the_default_move(name):
    rig, path = models.make(name), from_move(models.default_move(name))
    inputs = solve(rig, path, np.linspace(0, path.duration, 501)).inputs
    limits = np.array([drive.limit for drive in rig.drives])
    assert (np.abs(inputs).max(axis=0) * 4 / 3 < limits).all()


@pytest.mark.parametrize("name", list(CATALOGUE))
def test_toml_and_back(name, tmp_path):
    rig, move = models.make(name), models.default_move(name)
    models.dump(tmp_path / "rig.toml", rig, move)
    assert models.load(tmp_path / "rig.toml") == (rig, move)


def test_a_sampled_move_is_named_from_its_file_s_folder(tmp_path):
    (tmp_path / "made").mkdir()
    move = Move(profile="sampled", samples=str(tmp_path / "made" / "path.csv"))
    models.dump(tmp_path / "made" / "rig.toml", OVERHEAD, move)
    assert 'samples = "path.csv"' in (tmp_path / "made" / "rig.toml").read_text()
    assert models.load(tmp_path / "made" / "rig.toml") == (OVERHEAD, move)


def test_toml_may_name_a_catalogue_rig_with_overrides():
    rig, move = models.loads('rig = "overhead"\nload_mass = 80.0')
    assert rig == models.overhead_crane(load_mass=80.0)
    assert move == models.default_move("overhead_crane")
    rig, move = models.loads(
        'rig = "overhead"\n[move]\nstart = [0, -4]\ngoal = [1, -4]\nduration = 2'
    )
    assert move == Move((0.0, -4.0), (1.0, -4.0), 2)


def test_a_sheave_survives_toml():
    rig = change(
        masses=(Trolley("trolley", 1.0, "beam"), Load("pulley", 1.0), Load("load", 2.0)),
        ropes=(Rope("hoist", ("trolley", "pulley", "load"), 0.1, 0.1, (Sheave("pulley", 1, 2),)),),
        home={"pulley": (0, 0, -1), "load": (0.0, 0.0, -4.0)},
    )
    assert models.loads(models.dumps(rig)) == (rig, None)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("name = ", "not TOML"),
        ('nam = "a"', "unknown entry 'nam'; did you mean name?"),
        ('name = "a"', "the entry 'outputs' is missing"),
        ('rig = "ovrhead_crane"', "did you mean overhead_crane"),
        ('rig = "overhead"\nload_mas = 3', "no parameter 'load_mas'; did you mean load_mass?"),
        ('rig = "overhead"\nload_mass = -3', "mass is -3 kg"),
        ('rig = "overhead"\nload_mass = nan', "mass is nan"),
        ('rig = "overhead"\nload_mass = "heavy"', "must be a number"),
        ('name = "a"\noutputs = []\nropes = 3', "ropes must be an array of tables"),
        ('name = "a"\noutputs = []\n[[rails]]\nname = "r"', "the entry 'direction' is missing"),
        ('name = "a"\noutputs = []\n[[rails]]\nnaem = "r"', "did you mean name?"),
        ('name = "a"\noutputs = 3', "outputs"),
        ('name = 3\noutputs = ["x"]', "name"),
        ('name = "a"\noutputs = ["x"]\nhome = 3', "home"),
        ('name = "a"\noutputs = [1, 2]', "outputs is 1, it must be a name"),
    ],
)
def test_wrong_toml_is_one_clear_line(text, message):
    with pytest.raises(RigError) as error:
        models.loads(text)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


THREE = "start = [0, 0, 0]\ngoal = [1, 1, 1]\nduration = 1\n"


def test_wrong_moves_are_one_clear_line(tmp_path):
    for text, message in [
        ("start = [0, -4]\ngoal = [5, -1]\nduration = 0", "duration is 0 s, it must be > 0"),
        ("start = [0, nan]\ngoal = [5, -1]\nduration = 1", "start is nan, it must be finite"),
        ("start = [0]\ngoal = [5, -1]\nduration = 1", "start has 1 values and goal 2"),
        ('start = [0]\ngoal = [5]\nduration = 1\nprofile = "bang"', "there is no profile 'bang'"),
        ('profile = "sampled"', "needs `samples`"),
        ('profile = "sampled"\nsamples = "a.csv"\nturning = [0, 1, 2]', "leave `turning`, `rise`"),
        (f"{THREE}turning = [0, 1, 1]", "turning is (0, 1, 1), it must be three columns of 0 to 2"),
        (f"{THREE}turning = [0, 1]", "it must be three columns of 0 to 2"),
        (f"{THREE}turning = [0, 1, 1.5]", "turning is 1.5, it must be a whole number"),
        (f"{THREE}turning = [0, 1, [2]]", "turning is [2], it must be a number"),
        ("begin = [0]", "unknown entry 'begin'"),
        ('start = ["a"]\ngoal = [5]\nduration = 1', "start is 'a', it must be a number"),
        ('start = [1]\ngoal = [5]\nduration = "long"', "duration is 'long', it must be a number"),
        ("start = [1]\ngoal = [5]\nduration = true", "duration is True"),
        ('start = "05"\ngoal = [1, 5]\nduration = 1', "start is '05', it must be a list"),
        ("start = [1]\ngoal = [5]\nduration = 1\norder = -1", "order is -1"),
        ("samples = 3", "samples is 3, it must be a name"),
    ]:
        file = tmp_path / "rig.toml"
        file.write_text(f'rig = "overhead"\n[move]\n{text}')
        with pytest.raises(PathError) as error:
            models.load(file)
        assert message in str(error.value)
        assert "rig.toml" in str(error.value)


def test_files_that_cannot_be_read_or_written(tmp_path):
    with pytest.raises(RigError, match=r"cannot read .*missing\.toml: No such file"):
        models.load(tmp_path / "missing.toml")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(RigError, match="not a text file"):
        models.load(tmp_path / "binary.toml")
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OutputError, match="cannot write"):
        models.dump(tmp_path / "file" / "rig.toml", OVERHEAD)


def test_catalogue_names():
    assert models.full_name("overhead") == "overhead_crane"
    assert models.full_name("rotary-crane") == "rotary_crane"
    for spelled in ("Navy Crane 2D", "NavyCrane2D-v0", "flatrig/NavyCrane2D-v0", "navy_2d"):
        assert models.full_name(spelled) == "navy_crane_2d"
    with pytest.raises(RigError, match="no parameter 'mass'"):
        models.make("overhead", mass=3.0)


def test_a_rig_remembers_its_hash_in_its_own_process_only():
    rig = models.cable_robot()
    assert hash(rig) == hash(models.cable_robot())
    packed = pickle.dumps(rig)
    assert b"_hash" not in packed
    assert pickle.loads(packed) == rig
