"""Pulleys without mass: placed where all ropes pull, by the bisector law and by `solve`.

The second road knows no equations of motion.  The last span lies along the pull p = a + g of the
load's acceleration and gravity, so that the pulley is on that line through the load.  It is in
balance where the line to A halves the angle between the two spans of the hoist rope (K 3.7): with s
counted along p from A's height, h_A and h_P across it and d = s_P - s_A,

    (h_P - 2 h_A) s^2 + 2 d h_A s - h_P h_A^2 = 0,

and of its two roots one counts if both ropes pull.  In space A and P lie in the plane of that line
and the boom's foot, which gives the boom's angle.
"""

import re
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flatrig import models
from flatrig.feedforward import residuals, rest_to_rest, solve
from flatrig.models import Anchor, Drive, Frame, Load, PathError, Rig, Rope

CLOSE = 1e-7
"""What `solve` promises [m]."""
SEED = 1
"""Of the random moves."""


def across(vectors):
    """Unit vectors (N, dimensions)."""
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def on_the_line(load, pull, side, a, p):
    """Places (2, N, dimensions) of the pulley in balance with ropes that pull, NaN where none.

    `pull` and `side` (N, dimensions) are unit vectors along and across the load's pull.
    """
    s_a, h_a, s_p, h_p = (
        ((point - load) * axis).sum(axis=1) for point in (a, p) for axis in (pull, side)
    )
    d = s_p - s_a
    half = d * h_a
    root = np.abs(h_a) * np.sqrt(d * d + h_p * h_p - 2 * h_p * h_a)
    stable = -half - np.where(half < 0, -root, root)
    places = []
    for s in (stable / (h_p - 2 * h_a), -h_p * h_a**2 / stable):
        pulley = load + (s_a + s)[:, None] * pull
        to_a, to_p = across(a - pulley), across(p - pulley)
        spans = to_p - pull  # the hoist rope's tension times this and the tagline's balance
        balanced = np.linalg.norm(spans - (spans * to_a).sum(axis=1)[:, None] * to_a, axis=1) < 1e-9
        taut = (s_a + s > 0) & balanced & ((spans * to_a).sum(axis=1) < 0)
        places.append(np.where(taut[:, None], pulley, np.nan))
    return np.array(places)


def taut_places(rig, reference, times):
    """All places (K, N, dimensions) of the pulley with ropes that pull; NaN where there is none."""
    load, _, second = reference.derivatives(times, 2)
    second[:, -1] += rig.gravity
    pull = across(second)
    anchors = {anchor.name: np.array(anchor.position) for anchor in rig.anchors}
    with np.errstate(invalid="ignore", divide="ignore"):
        if rig.dimensions == 2:
            side = np.stack([-pull[:, 1], pull[:, 0]], axis=1)
            return on_the_line(load, pull, side, anchors["A"][[0, 2]], anchors["P"][[0, 2]])
        normal = across(np.cross(load, pull))
        radius, _, height = anchors["P"]  # the boom lies in the plane: normal . P = 0
        middle = np.arctan2(normal[:, 1], normal[:, 0])
        reach = radius * np.hypot(normal[:, 0], normal[:, 1])
        apart = np.arccos(-height * normal[:, 2] / reach)
        places = []
        for angle in (middle + apart, middle - apart):
            a, p = (
                np.stack([x * np.cos(angle), x * np.sin(angle), np.full_like(angle, z)], axis=1)
                for x, _, z in (anchors["A"], anchors["P"])
            )
            places += [*on_the_line(load, pull, np.cross(normal, pull), a, p)]
    return np.array(places)


def random_crane(dimensions, rng):
    """A Navy crane, a massless pulley, a move between places where all ropes pull at rest."""
    values = {
        "pulley_mass": 0,
        "load_mass": 10 ** rng.uniform(0, 3),
        "drum_radius": rng.uniform(0.05, 0.3),
        "boom_angle": rng.uniform(0.5, 1.4),
    }
    if dimensions == 2:
        rig = models.navy_crane_2d(tagline_distance=rng.uniform(4, 12), **values)
        edge, duration = rig.anchors[0].position[0], rng.uniform(3, 20)
        start, goal = ((rng.uniform(0.02, 0.9) * edge, -rng.uniform(9, 18)) for _ in range(2))
    else:
        rig = models.navy_crane_3d(tagline_distance=rng.uniform(3, 7), **values)
        inner, outer = (anchor.position[0] for anchor in rig.anchors)
        middle, duration = rng.uniform(-3, 3), rng.uniform(8, 30)
        polar = [
            (inner + rng.uniform(0.1, 0.95) * (outer - inner), middle + rng.uniform(-0.7, 0.7))
            for _ in range(2)
        ]
        start, goal = (
            (radius * np.cos(angle), radius * np.sin(angle), -rng.uniform(5, 15))
            for radius, angle in polar
        )
    return rig, rest_to_rest(start, goal, duration, order=int(rng.integers(4, 7)))


def pulley_of(motion):
    return motion.positions[:, [motion.column(f"pulley.{axis}") for axis in motion.rig.axes]]


@pytest.mark.parametrize(("dimensions", "moves"), [(2, 10), (3, 5)])
def test_random_moves_are_made_with_the_one_pulley_whose_ropes_pull(dimensions, moves):
    rng = np.random.default_rng(SEED)
    made = 0
    for _ in range(moves):
        rig, reference = random_crane(dimensions, rng)
        times = np.linspace(0, reference.duration, 41)
        places = taut_places(rig, reference, times)
        count = (~np.isnan(places[..., 0])).sum(axis=0)
        assert (count <= 1).all()
        if (count == 1).all():
            motion = solve(rig, reference, times)
            assert_allclose(pulley_of(motion), np.nansum(places, axis=0), rtol=0, atol=CLOSE)
            assert not motion.slack
            made += 1
    assert made > 0.8 * moves


@pytest.mark.parametrize(
    ("values", "start", "goal", "duration"),
    [
        ((250.965, 0.099, 1.142, 8.803), (-2.017, -14.492), (-3.919, -11.703), 11.063),
        ((1.327, 0.1, 0.76, 8.016), (-1.65, -14.571), (-1.763, -13.46), 19.6),
        ((22.44, 0.1, 1.236, 10.126), (-5.6, -15.608), (-3.025, -12.373), 19.17),
        # Those were refused; these were solved with a tagline that pushes all along.
        ((172.92, 0.252, 1.2481, 5.4226), (-2.9402, -10.7707), (-1.2048, -13.4461), 11.878),
        ((47.681, 0.296, 0.8473, 11.0855), (-4.9633, -17.2453), (-2.7587, -12.7503), 9.2786),
    ],
)
def test_moves_whose_approach_lost_its_way(values, start, goal, duration):
    names = ("load_mass", "drum_radius", "boom_angle", "tagline_distance")
    rig = models.navy_crane_2d(pulley_mass=0, **dict(zip(names, values, strict=True)))
    reference = rest_to_rest(start, goal, duration, order=4)
    times = np.linspace(0, duration, 101)
    motion = solve(rig, reference, times)
    assert residuals(motion, reference).max() < 1e-9
    assert not motion.slack
    places = taut_places(rig, reference, times)
    assert ((~np.isnan(places[..., 0])).sum(axis=0) == 1).all()
    assert_allclose(pulley_of(motion), np.nansum(places, axis=0), rtol=0, atol=CLOSE)


def test_a_start_that_stays_straight_for_long():
    """The load leaves the plumb line by 0.1 m in 15 s: nothing tells within the first hundredth."""
    rig = models.navy_crane_2d(
        pulley_mass=0, load_mass=341.69, boom_angle=1.3897, tagline_distance=4.089
    )
    reference = rest_to_rest((0.0, -10.7567), (-0.1282, -17.1634), 15.5132)
    times = np.linspace(0, reference.duration, 101)
    places = np.nansum(taut_places(rig, reference, times), axis=0)
    motion = solve(rig, reference, times)
    assert_allclose(pulley_of(motion)[3:], places[3:], rtol=0, atol=CLOSE)
    assert_allclose(motion.tensions[0], [0.0, rig.weight], atol=1e-9 * rig.weight)


def gantry_with_a_pulley(home):
    """A gantry that slides along y carries both winches: the plane Navy crane, moved."""
    return Rig(
        name="gantry_with_a_pulley",
        frames=(Frame("gantry", "sliding", 50.0, axis=(0.0, 1.0, 0.0)),),
        anchors=(Anchor("A", (6.0, 0.0, -4.0), "gantry"), Anchor("P", (0.0, 0.0, 0.0), "gantry")),
        masses=(Load("pulley", 0.0), Load("load", 80.0)),
        ropes=(
            Rope("tagline", ("A", "pulley"), drum_radius=0.1, winch_inertia=0.1),
            Rope("hoist", ("P", "pulley", "load"), drum_radius=0.1, winch_inertia=0.1),
        ),
        drives=(
            Drive("gantry", on="gantry", limit=1e3),
            Drive("tagline", on="tagline", limit=1e3),
            Drive("hoist", on="hoist", limit=1e3),
        ),
        outputs=("load.x", "load.y", "load.z"),
        home={"pulley": home, "load": (0.0, 0.0, -12.0)},
    )


@pytest.mark.parametrize("height", [-1.0, 3.0])
def test_a_rig_of_one_s_own_wherever_its_home_has_the_pulley(height):
    """The gantry rides above the load, and the pulley hangs in its plane."""
    rig = gantry_with_a_pulley((0.0, 0.0, height))
    reference = rest_to_rest((1.5, 2.0, -12.0), (4.0, 2.0, -9.0), 9.0)
    times = np.linspace(0, 9, 61)
    motion = solve(rig, reference, times)
    plane = replace(
        rig,
        dimensions=2,
        frames=(),
        anchors=(Anchor("A", (6.0, 0.0, -4.0)), Anchor("P", (0.0, 0.0, 0.0))),
        drives=rig.drives[1:],
        outputs=("load.x", "load.z"),
        home={"pulley": (0.0, 0.0, height), "load": (0.0, 0.0, -12.0)},
    )
    places = np.nansum(taut_places(plane, rest_to_rest((1.5, -12), (4, -9), 9.0), times), axis=0)
    assert_allclose(pulley_of(motion)[:, [0, 2]], places, rtol=0, atol=CLOSE)
    assert_allclose(pulley_of(motion)[:, 1], 2.0, rtol=0, atol=CLOSE)


def test_a_path_on_which_the_pulley_has_no_place_says_which_rope_pushes_from_when():
    """Neither root of the law is real for a moment at 1.35 s; a rope pushes from 1.1 s on."""
    rig = models.navy_crane_2d(
        pulley_mass=0, load_mass=10.38, boom_angle=1.37743445, tagline_distance=6.84922288
    )
    reference = rest_to_rest((-4.0466388, -14.4198953), (-0.6203682, -14.2725068), 3.79261943, 6)
    times = np.linspace(0, reference.duration, 20001)
    places = taut_places(rig, reference, times)
    taut = (~np.isnan(places[..., 0])).any(axis=0)
    pushes = times[(~taut).argmax()]
    with pytest.raises(PathError) as refused:
        solve(rig, reference, 0.0)
    said = str(refused.value)
    (when,) = (float(t) for t in re.findall(r"at t = ([\d.]+) s \(", said))
    (since,) = (
        float(t) for t in re.findall(r"rope tagline would have to push from ([\d.]+) s", said)
    )
    assert since == pytest.approx(pushes, abs=2e-3)
    assert pushes < when < pushes + 0.3


def test_a_lost_approach_does_not_blame_the_path():
    """The path lies above the rail; the way to its start is what fails."""
    lost = r"the approach from its home to the start of the path, in rest, is lost at load\.x = "
    with pytest.raises(PathError, match=lost):
        solve(models.overhead_crane(), rest_to_rest((1, 3), (2, 4), 9.0), 0.0)
