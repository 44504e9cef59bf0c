"""What no chain of bodies holds: ropes between two frames, skew rails, and two platforms.

Each rig is followed open loop in MuJoCo, or its accelerations are compared with the equations'.
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import models
from flatrig.feedforward import analyse, equations_of, from_move, redundant, solve
from flatrig.models import (
    Anchor,
    Drive,
    Frame,
    Link,
    Load,
    ModelError,
    Move,
    Platform,
    Rail,
    Rig,
    Rope,
    Trolley,
)
from flatrig.models.mjcf import rig_model
from flatrig.models.mjcf.simulate import accelerations, run
from flatrig.models.rig.chain import apart
from flatrig.models.rig.lengths import rope_lengths

X = (1.0, 0.0, 0.0)


def two_cranes():
    """Two slewing cranes that carry a beam whose mass is at its ends, without pulling at it."""
    return Rig(
        name="two_cranes",
        frames=(
            Frame("crane_1", "turning", 5e4, origin=(-12.0, 0, 0)),
            Frame("crane_2", "turning", 5e4, origin=(12.0, 0, 0)),
        ),
        rails=(Rail("jib_1", X, frame="crane_1"), Rail("jib_2", (-1.0, 0, 0), frame="crane_2")),
        masses=(
            Trolley("trolley_1", 500.0, "jib_1"),
            Trolley("trolley_2", 500.0, "jib_2"),
            Load("left", 2000.0),
            Load("right", 2000.0),
        ),
        ropes=(
            Rope("hoist_1", ("trolley_1", "left"), 0.2, 20.0),
            Rope("hoist_2", ("trolley_2", "right"), 0.2, 20.0),
        ),
        links=(Link("beam", ("left", "right"), pushes=True),),
        drives=tuple(
            Drive(name, name, 1e5)
            for name in ("crane_1", "trolley_1", "hoist_1", "crane_2", "trolley_2", "hoist_2")
        ),
        outputs=("left.x", "left.y", "left.z", "right.y", "right.z", "beam.tension"),
        home={"trolley_1": 7.0, "trolley_2": 7.0, "left": (-5, 0, -10), "right": (5, 0, -10)},
    )


def skew_rails():
    """A load between a level trolley and one on a slope."""
    return Rig(
        name="skew",
        dimensions=2,
        rails=(Rail("level", X), Rail("slope", (0.6, 0.0, 0.8), (4.0, 0.0, 0.0))),
        masses=(Trolley("a", 50.0, "level"), Trolley("b", 40.0, "slope"), Load("load", 100.0)),
        ropes=(Rope("one", ("a", "load"), 0.1, 0.1), Rope("two", ("b", "load"), 0.1, 0.1)),
        drives=tuple(Drive(name, name, 1e4) for name in ("a", "b", "one", "two")),
        outputs=("load.x", "load.z", "a.position", "b.position"),
        home={"load": (2.0, 0, -3.0)},
    )


def two_beams():
    """A beam in a plane below another one, which hangs from two trolleys."""
    ends = [Anchor(f"{beam}_{k}", (side, 0, 0.3), beam) for beam in ("upper", "lower")
            for k, side in enumerate((-2.0, 2.0))]  # fmt: skip
    low = [Anchor(f"winch_{k}", (side, 0, -0.3), "upper") for k, side in enumerate((-1.5, 1.5))]
    names = [f"{beam}_rope_{k}" for beam in ("upper", "lower") for k in (0, 1)]
    return Rig(
        name="two_beams",
        dimensions=2,
        anchors=(*ends, *low),
        rails=(Rail("rail", X),),
        masses=(
            *(Trolley(f"t{k}", 300.0, "rail") for k in (0, 1)),
            *(Platform(name, 400.0, (300.0,) * 3) for name in ("upper", "lower")),
        ),
        ropes=(
            *(Rope(f"upper_rope_{k}", (f"t{k}", f"upper_{k}"), 0.2, 2.0) for k in (0, 1)),
            *(Rope(f"lower_rope_{k}", (f"winch_{k}", f"lower_{k}"), 0.2, 2.0) for k in (0, 1)),
        ),
        drives=tuple(Drive(name, name, 1e4) for name in ("t0", "t1", *names)),
        outputs=("t0.position", "t1.position", *(f"{name}.length" for name in names)),
        home={"t0": -2.2, "t1": 2.2, "upper": (0, 0, -5.0), "lower": (0, 0, -9.0)},
    )


def landed(rig, move, **options):
    model, step = models.compile(rig, visuals=False, **options), 1e-3
    times = (np.arange(round(move.duration / step)) + 0.5) * step
    motion = solve(rig, from_move(move), np.array([0.0, *times, move.duration]))
    start = {n: motion.positions[0, motion.column(n)] for n in rig.home_coordinates}
    first = rig_model.joint_state(rig, model, start, tensions=motion.tensions[0, : len(rig.ropes)])
    state = run(model, *first, motion.inputs[1:-1])
    values, _ = rig_model.coordinates(rig, model, rig_model.State(state.qpos[-1:], state.qvel[-1:]))
    ends = [values[n][0] - motion.positions[-1, motion.column(n)] for n in rig.home_coordinates]
    return np.abs(ends).max()


def test_two_cranes_land_their_beam():
    rig = two_cranes()
    assert analyse(rig).reference_order == 4
    assert "tie frames crane_1 and crane_2 together" in apart(rig)
    move = Move((-5, 0, -10, 0, -10, 0.0), (-6.5, 3.0, -8, 3.5, -8, 0.0), 15.0)
    assert landed(rig, move) < 2.8e-8
    pushed = replace(move, start=(*move.start[:5], 500.0), goal=(*move.goal[:5], -500.0))
    motion = solve(rig, from_move(pushed), [0.0, 15.0])
    assert_allclose(motion.tensions[:, 2], (500.0, -500.0), atol=1e-9)


def test_a_load_between_rails_that_are_not_parallel_lands():
    assert "not parallel" in apart(skew_rails())
    move = Move((2.0, -3.0, 0, 0), (2.6, -2.0, 0.5, -0.4), 8.0)
    assert landed(skew_rails(), move) < 1e-7


def test_ropes_as_constraints_are_rigid_ropes():
    rig, move = models.overhead_crane(), models.default_move("overhead")
    assert not apart(rig)
    assert landed(rig, move, ropes="equality") < 1e-5
    with pytest.raises(ModelError, match="ropes: equality ropes have no stiffness; elastic ones"):
        models.Ropes("equality", stiffness=1e6)


@pytest.mark.parametrize("make", [two_cranes, skew_rails, two_beams])
@pytest.mark.parametrize("ropes", ["rigid", "elastic", "slack"])
def test_they_rest_at_home(make, ropes):
    rig = make()
    model = models.compile(rig, visuals=False, ropes=ropes)
    home = model.key("home")
    qacc = accelerations(model, home.qpos, np.zeros(model.nv), home.ctrl)
    assert np.abs(qacc).max() < 1e-7


def in_motion(rig, count):
    """Random coordinates and rates about home that keep the links' lengths, (count,) each."""
    random = np.random.default_rng(1)
    turn = {name: 0.1 if name in rig.angles else 0.5 for name in rig.home_coordinates}
    values, rates = (
        {name: home * share + size * random.uniform(-1, 1, count) for (name, home), size in
         zip(rig.home_coordinates.items(), turn.values(), strict=True)}
        for share in (1.0, 0.0)
    )  # fmt: skip
    for link in rig.links:
        here, there = ([f"{end}.{axis}" for axis in rig.axes] for end in link.ends)
        step, speed = (
            np.stack([table[b] - table[a] for a, b in zip(here, there, strict=True)])
            for table in (values, rates)
        )
        along = step / np.linalg.norm(step, axis=0)
        for a, b, part in zip(here, there, along, strict=True):
            values[b] = values[a] + rig.link_length(link) * part
            rates[b] = rates[b] - (speed * along).sum(axis=0) * part
    return values, rates


def constrained(rig, model, values, rates, ctrl):
    """The state of the model at which its constraints give what rigid ropes and links would.

    MuJoCo asks J a = aref - R f of a constraint with aref = -K I r at a stretch r, K I = 1/(I t^2)
    and R = (1 - I)/I A (solimp I, solref t): it knows nothing of J' v.  So the stretch at which a
    and f are those of J a + J' v = 0 is r = I t^2 J' v + (1 - I) t^2 A T at a tension T.  A link's
    is in its ends' places, where the equations are taken, too.
    """
    equations = equations_of(rig)
    share, time, first = model.eq_solimp[0, 0], model.eq_solref[0, 0], model.nq - len(rig.ropes)
    begin = dict(values)
    for _ in range(3 if rig.links else 1):
        state, speeds = redundant(equations, values, rates)
        exact, multipliers = equations.accelerations(state, speeds, ctrl)
        pulls = equations.tensions(state, multipliers)
        start = rig_model.joint_state(rig, model, values, rates, tensions=pulls)
        world = rig_model.points(rig, *start, np.zeros_like(start.qvel))
        for column, link in enumerate(rig.links, start=len(rig.ropes)):
            one, two = (world[end] for end in link.ends)
            (step, speed), length = (two - one)[:2], rig.link_length(link)
            along = step / np.linalg.norm(step, axis=-1, keepdims=True)
            drift = np.square(speed).sum(-1) - np.square((speed * along).sum(-1))
            give = (1.0 - share) * model.tendon_invweight0[model.tendon(link.name).id]
            stretch = time**2 * (share * drift / length + give * pulls[:, column])
            for axis, part in zip("xyz", (stretch[:, None] * along).T, strict=True):
                if axis in rig.axes:
                    values[f"{link.ends[1]}.{axis}"] = begin[f"{link.ends[1]}.{axis}"] + part
    lengths = rope_lengths(rig, world)
    drift = np.stack([lengths[rope.name][2] for rope in rig.ropes], axis=-1)
    qpos = start.qpos.copy()
    qpos[:, first:] -= share * time**2 * drift
    return rig_model.State(qpos, start.qvel), dict(zip(equations.names, exact.T, strict=True))


@pytest.mark.parametrize("make", [two_cranes, models.tandem_lift, skew_rails, two_beams])
def test_accelerations_at_random_states_are_those_of_the_equations(make):
    """At speeds to 0.5 m/s; the last digit of a constraint's length is an acceleration of 3e-8."""
    rig = make()
    model = models.compile(rig, visuals=False)
    ctrl = model.key_ctrl[0] * np.random.default_rng(0).uniform(0.7, 1.3, (6, model.nu))
    values, rates = in_motion(rig, 6)
    state, exact = constrained(rig, model, values, rates, ctrl)
    world = rig_model.points(rig, *state, accelerations(model, *state, ctrl))
    for part in rig.hanging:
        for axis in rig.axes:
            found = world[part.name][2][:, "xyz".index(axis)]
            assert_allclose(found, exact[f"{part.name}.{axis}"], rtol=0, atol=3e-8)
