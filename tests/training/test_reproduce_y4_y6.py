"""Figures of Y chapters 4 to 6: the source's machines, the quantities it names, and what is said.

Numbers are the source's, and the multipliers are held against its equations of motion.
"""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.text import Text

import flatrig
from flatrig.training.reproduce import figures_y, snapshots
from flatrig.training.reproduce.entry import entries
from flatrig.training.reproduce.figures_y_data import FIGURES, Lines, Snapshots
from flatrig.training.reproduce.shown import quantity

ROOT3 = math.sqrt(3.0)
LINES = [name for name, content in FIGURES.items() if isinstance(content, Lines)]


def distinct(kind):
    """Figures of a kind, leaving out those that differ in title, numbers or step alone."""
    named = {}
    for name, content in FIGURES.items():
        if isinstance(content, kind):
            lines = (*content.panels, len(content.runs)) if kind is Lines else content.views
            named.setdefault((content.case.name, content.case.move, lines), name)
    return [*named.values()]


def numbers(name):
    """What a figure's crane is made of: masses, inertias of frames, drums and their inertias."""
    rig = FIGURES[name].case.rig
    return (
        {mass.name: mass.mass for mass in (*rig.loads, *rig.trolleys, *rig.platforms)},
        {frame.name: frame.inertia for frame in rig.frames},
        {rope.drum_radius for rope in rig.ropes},
        [rope.winch_inertia for rope in rig.ropes],
    )


@pytest.mark.parametrize("name", ["Y4.7", "Y4.8", "Y4.9"])
def test_the_rotary_crane_of_chapter_4_is_that_of_table_4_1(name):
    masses, frames, drums, winches = numbers(name)
    assert masses == {"trolley": 50.0 + 3.0, "load": 10.0}
    assert frames == {"bridge": pytest.approx(16.67 + 2.08 + 0.26)}
    assert (drums, winches) == ({0.1}, [0.02])


@pytest.mark.parametrize(
    "name", ["Y5.7", "Y5.8", "Y5.9", "Y5.12", "Y5.13", "Y5.14", "Y5.15", "Y5.16"]
)
def test_the_rotary_cranes_of_chapter_5_have_the_data_of_5_3_2(name):
    masses, frames, drums, winches = numbers(name)
    assert masses == {"trolley": 10.0, "load": 100.0}
    assert frames == {"bridge": 480.0}
    assert drums == {0.1}
    rig = FIGURES[name].case.rig
    sheaves = [sheave.inertia for rope in rig.ropes for sheave in rope.sheaves]
    if rig.name == "extended_rotary_crane":  # Y 5.4.4: J_1 = J_2 = 0
        assert sheaves == [0.1]
        assert max(winches) < 1e-6
    else:
        assert (winches, sheaves) == ([0.1], [])


@pytest.mark.parametrize(
    ("names", "masses", "frames"),
    [
        (("Y4.2", "Y4.3", "Y4.4", "Y5.3", "Y5.5"), {"trolley": 10.0, "load": 100.0}, {}),
        (("Y6.2", "Y6.4", "Y6.5"), {"pulley": 0.0, "load": 100.0}, {}),
        (("Y6.7", "Y6.9", "Y6.10"), {"pulley": 150.0, "load": 100.0}, {}),
        (("Y6.13", "Y6.14"), {"pulley": 0.0, "load": 100.0}, {"boom": 6.4 * 75.0}),
        (("Y6.16", "Y6.17"), {"pulley": 5.0, "load": 100.0}, {"boom": 6.4 * 75.0}),
    ],
)
def test_other_cranes_have_the_printed_masses(names, masses, frames):
    for name in names:
        found = numbers(name)
        assert found[0] == masses
        assert found[1] == {key: pytest.approx(value) for key, value in frames.items()}
        assert (found[2], set(found[3])) == ({0.1}, {0.1})


def test_cablev_has_the_printed_masses():
    for name in (f"Y6.{k}" for k in range(21, 31)):
        masses, frames, drums, winches = numbers(name)
        assert masses == {"platform": 12.5} | {f"trolley_{i}": 35.0 for i in (1, 2, 3)}
        assert frames == {"gantry": pytest.approx(380.0 - 3 * 35.0)}  # moves with the trolleys
        assert (drums, winches) == ({0.1}, [0.75, 0.75, 1.5])


TEXT = {
    ("Y4.3", "Y4.4"): r"s l F M \lambda",
    ("Y4.8", "Y4.9", "Y5.7", "Y5.8"): r"\varphi s l M_b F_t M_w",
    ("Y5.3", "Y5.4"): "s l F_t M_w",
    ("Y5.12", "Y5.13"): r"\varphi s l",
    ("Y5.14",): "x_2 y_2 x_0 y_0 L_1 L_2 L_0",
    ("Y6.2",): "L_1 L_2 L_0 x_0 z_0",
    ("Y6.3",): "u_1 u_2",
    ("Y6.4",): r"\lambda_1 \lambda_2 \lambda_3",
    ("Y6.7",): "L_1 L_2 L_3 L_0 x_0",
    ("Y6.8",): "u_1 u_2 u_3",
    ("Y6.9",): r"\lambda_1 \lambda_2 \lambda_3 \lambda_4",
    ("Y6.13",): (
        r"L_1 L_3 L_0 x_0 y_0 z_0 x_3 y_3 u_1 u_3 u_4 \lambda_1 \lambda_2 \lambda_3 \lambda_4"
    ),
    ("Y6.16",): (
        r"L_1 L_2 L_3 L_0 x_0 y_0 x_3 y_3 u_1 u_2 u_3 u_4 "
        r"\lambda_1 \lambda_2 \lambda_3 \lambda_4 \lambda_5"
    ),
    ("Y6.21", "Y6.22"): "robot",
    ("Y6.25",): "robot",
    ("Y6.27", "Y6.28"): "robot",
}
"""Symbols of the quantities that the source's text names for its figures, some for two together."""
ROBOT = {
    *(f"p_{{g{i}}}" for i in range(4)),
    *(f"p_{{c{i}}}" for i in (1, 2, 3)),
    *(f"u_{{g{i}}}" for i in range(4)),
    *(f"u_{{c{i}}}" for i in (1, 2, 3)),
    *(rf"\lambda_{i}" for i in (1, 2, 3)),
}


def symbols(name):
    """The source's quantities over a figure's names: name, and what one has to be divided by."""
    found = {}
    for what, text in FIGURES[name].panels.items():
        sign, factor, symbol = re.fullmatch(r"(-?)(2|r\^2|)(.*)", text).groups()
        scale = {"": 1.0, "2": 2.0, "r^2": 75.0}[factor]
        found[symbol] = (what, -scale if sign else scale)
    return found


@pytest.mark.parametrize("names", TEXT, ids=" ".join)
def test_a_figure_shows_what_the_text_names(names):
    together = set().union(*(symbols(name) for name in names))
    if TEXT[names] == "robot":
        assert together >= ROBOT
        return
    for name in names:
        assert set(symbols(name)) == set(TEXT[names].split())


def test_every_figure_over_time_is_held_against_the_text():
    assert sorted(name for names in TEXT for name in names) == sorted(LINES)


def exact(name, count=41):
    case = FIGURES[name].case
    return figures_y.exact(case, np.linspace(0.0, case.path.duration, count))


def read(name, motion):
    """The source's quantities by its symbols, (N,) each."""
    return {
        symbol: quantity(motion, what) / scale for symbol, (what, scale) in symbols(name).items()
    }


def second(motion, name):
    return motion.accelerations[:, motion.column(name)]


def test_multiplier_of_the_overhead_crane_is_the_printed_one():
    """Y 4.79a, whose z points down, and which is 196.2 N/m in the middle."""
    motion = exact("Y4.3")
    z = -motion.positions[:, motion.column("load.z")]
    expected = 100.0 * (9.81 + second(motion, "load.z")) / (2.0 * z)
    assert read("Y4.3", motion)[r"\lambda"] == pytest.approx(expected)
    assert expected[20] == pytest.approx(196.2)


def test_multipliers_of_the_planar_navy_crane_satisfy_the_printed_equations():
    """Y A.3, every line that has a multiplier."""
    motion = exact("Y6.9")
    v = read("Y6.7", motion) | read("Y6.8", motion) | read("Y6.9", motion)
    one, two, three, four = (v[rf"\lambda_{i}"] for i in (1, 2, 3, 4))
    x0, z0, x, z = (
        motion.positions[:, motion.column(name)]
        for name in ("pulley.x", "pulley.z", "load.x", "load.z")
    )
    sine, cosine, s, length, mass, pulley = 0.5 * ROOT3, 0.5, 5.0, 10.0, 100.0, 150.0
    left = (
        10.0 * second(motion, "tagline.length"), 10.0 * second(motion, "hoist.length"),
        10.0 * second(motion, "suspension.length"), 0.0,
        pulley * second(motion, "pulley.x"), pulley * (second(motion, "pulley.z") + 9.81),
        mass * second(motion, "load.x"), mass * (second(motion, "load.z") + 9.81),
    )  # fmt: skip
    far = length + s
    right = (
        -one * v["L_1"] + v["u_1"] / 0.1,
        four * (v["L_0"] - v["L_2"]) + v["u_2"] / 0.1,
        -three * v["L_3"] + v["u_3"] / 0.1,
        -two * v["L_0"] + four * (v["L_2"] - v["L_0"]),
        one * (x0 + far * sine) + two * (x0 + s * sine) + three * x0 + four * (x0 - x),
        one * (z0 + far * cosine) + two * (z0 + s * cosine) + three * z0 + four * (z0 - z),
        four * (x - x0),
        four * (z - z0),
    )
    for number, sides in enumerate(zip(left, right, strict=True)):
        assert sides[1] == pytest.approx(sides[0], abs=1e-7), number


@pytest.mark.parametrize(("name", "order"), [("Y6.13", "1243"), ("Y6.16", "24513")])
def test_multipliers_of_the_navy_crane_satisfy_the_printed_equations(name, order):
    """Y A.4 and A.5: load, boom tip and ropes; `order` has tagline, hoist twice, circle, S."""
    motion = exact(name)
    v = read(name, motion)
    tagline, upper, lower, circle, *suspension = (v[rf"\lambda_{i}"] for i in order)
    place = np.array([motion.positions[:, motion.column(f"pulley.{axis}")] for axis in "xyz"])
    load = np.array([motion.positions[:, motion.column(f"load.{axis}")] for axis in "xyz"])
    tip = np.array([v["x_3"], v["y_3"], np.full(len(motion.times), 5.0)])
    force = 100.0 * np.array([second(motion, f"load.{axis}") for axis in "xyz"])
    force[2] += 981.0
    assert lower * (load - place) == pytest.approx(force, abs=1e-6)
    turn, rate = second(motion, "boom.angle"), motion.velocities[:, motion.column("boom.angle")]
    across = np.array([-tip[1], tip[0]])
    expected = 6.4 * (turn * across - rate**2 * tip[:2])
    found = circle * tip[:2] - tagline * 0.5 * (place - 0.5 * tip)[:2] + v["u_4"] * across / 75.0
    found -= upper * (place - tip)[:2]
    if suspension:
        found -= suspension[0] * 1.5 * (place - 1.5 * tip)[:2]
        rope = -suspension[0] * v["L_2"] + v["u_2"] / 0.1
        assert rope == pytest.approx(10.0 * second(motion, "suspension.length"), abs=1e-6)
    assert found == pytest.approx(expected, abs=1e-6)
    rope = -tagline * v["L_1"] + v["u_1"] / 0.1
    assert rope == pytest.approx(10.0 * second(motion, "tagline.length"), abs=1e-6)
    rope = lower * (v["L_0"] - v["L_3"]) + v["u_3"] / 0.1
    assert rope == pytest.approx(10.0 * second(motion, "hoist.length"), abs=1e-6)
    assert upper * v["L_0"] == pytest.approx(lower * (v["L_3"] - v["L_0"]), abs=1e-6)


def test_multipliers_of_cablev_carry_and_push_the_platform():
    """Y A.6 with z down: winches' lines, and the sum of the ropes' forces along the vertical."""
    motion = exact("Y6.28")
    v = read("Y6.27", motion) | read("Y6.28", motion)
    for i, inertia in zip((1, 2, 3), (75.0, 75.0, 150.0), strict=True):
        rope = v[f"u_{{c{i}}}"] / 0.1 - v[f"p_{{c{i}}}"] * v[rf"\lambda_{i}"]
        assert rope == pytest.approx(inertia * second(motion, f"hoist_{i}.length"), abs=1e-6)
    assert [v[rf"\lambda_{i}"][0] for i in (1, 2, 3)] == pytest.approx([-13.625] * 3)


def test_starts_are_the_printed_configurations():
    """Y 5.135 with 5.142, 6.11, 6.24, 6.36, 6.49 and 6.123."""
    printed = {
        "Y4.8": ("varphi s l", (0.0, 5.0, 5.0)),
        "Y5.12": ("varphi s l", (0.0, 5.0, 5.0)),
        "Y5.14": ("x_2 y_2 x_0 y_0 L_1 L_2 L_0", (-4.0, 0.0, 5.0, 0.0, 7.0, 14.0, 9.0)),
        "Y6.2": ("L_1 L_2 L_0 x_0 z_0", (5 * ROOT3, 15.0, 5.0, 0.0, -5.0)),
        "Y6.7": ("L_1 L_2 L_3 L_0 x_0", (10.0, 20.0, 13.23, 10.0, -2.5 * ROOT3)),
        "Y6.13": (
            "L_1 L_3 L_0 x_0 y_0 z_0 x_3 y_3",
            (2.5 * ROOT3, 20.0, 2.5, 5 * ROOT3, 0.0, 2.5, 5 * ROOT3, 0.0),
        ),
        "Y6.16": (
            "L_1 L_2 L_3 L_0 x_0 y_0 x_3 y_3",
            (2.5 * ROOT3, 6.6144, 20.0, 2.5, 5 * ROOT3, 0.0, 5 * ROOT3, 0.0),
        ),
        "Y6.21": (
            "p_{g0} p_{g1} p_{g2} p_{g3} p_{c1} p_{c2} p_{c3}",
            (1.2, 1.0 + 0.6 * ROOT3, 1.0, 1.0, 3.0, 3.0, 3.0),
        ),
    }
    for name, (names, values) in printed.items():
        found = read(name, exact(name, 3))
        found = [found[symbol.replace("varphi", r"\varphi")][0] for symbol in names.split()]
        rounded = {13.23: 5e-3, 6.6144: 5e-5}
        for value, expected in zip(found, values, strict=True):
            assert value == pytest.approx(expected, abs=rounded.get(expected, 1e-6)), name


def test_inputs_of_the_rotary_crane_follow_from_the_closed_form():
    """Y 4.118 to 4.122 with table 4.1's numbers, differentiated on a fine grid."""
    motion = exact("Y4.9", 8001)
    t, way = motion.times, motion.outputs
    x2, y2, z2 = (second(motion, f"load.{axis}") for axis in "xyz")
    ax, ay = (way[:, i] - way[:, 2] * a / (z2 + 9.81) for i, a in ((0, x2), (1, y2)))
    s, angle = np.hypot(ax, ay), np.unwrap(np.arctan2(ay, ax))
    tension = 10.0 * np.sqrt(x2**2 + y2**2 + (z2 + 9.81) ** 2)
    rope = np.sqrt((way[:, 0] - ax) ** 2 + (way[:, 1] - ay) ** 2 + way[:, 2] ** 2)
    first = [np.gradient(value, t) for value in (angle, s, rope)]
    accelerations = [np.gradient(value, t) for value in first]
    pull = tension / rope * (way[:, :2].T - (ax, ay))
    along = pull[0] * np.cos(angle) + pull[1] * np.sin(angle)
    across = pull[1] * np.cos(angle) - pull[0] * np.sin(angle)
    bridge = (19.01 + 53.0 * s**2) * accelerations[0] + 106.0 * s * first[1] * first[0]
    expected = (
        bridge - s * across,
        53.0 * (accelerations[1] - s * first[0] ** 2) - along,
        0.1 * (2.0 * accelerations[2] - tension),
    )
    inside = np.ones(len(t), bool)
    for join in (0.0, 5.0, 15.0, 20.0):  # where differences reach over a kink
        inside &= np.abs(t - join) > 0.03
    for found, value in zip(motion.inputs.T, expected, strict=True):
        assert found[inside] == pytest.approx(value[inside], abs=2e-3)
    extremes = np.array([motion.inputs.min(axis=0), motion.inputs.max(axis=0)])
    assert extremes[0] == pytest.approx([-16.11, -9.56, -9.918], abs=5e-3)
    assert extremes[1] == pytest.approx([11.10, 0.0, -9.708], abs=5e-3)


def test_what_is_said_about_alt_holds_and_stands_where_it_belongs():
    """Y 4.4.2: neither wrong Coriolis signs nor anything but 9.80 for 9.81 makes the 0.1."""
    remarked = {name for name, entry in entries().items() if "ALT stays off" in entry.caption}
    assert remarked == {"Y4.8", "Y4.9"}
    motion = exact("Y4.9", 401)
    s, rate, turn = (
        column[:, motion.column(name)]
        for column, name in (
            (motion.positions, "trolley.position"),
            (motion.velocities, "trolley.position"),
            (motion.velocities, "bridge.angle"),
        )
    )
    assert np.abs(4.0 * 53.0 * s * rate * turn).max() == pytest.approx(25.0, abs=0.1)
    assert np.abs(2.0 * 53.0 * s * turn**2).max() == pytest.approx(18.2, abs=0.1)
    case = FIGURES["Y4.9"].case
    slip = figures_y.exact(
        replace(case, overrides=(*case.overrides, ("gravity", 9.80))), motion.times
    )
    assert motion.tensions - slip.tensions == pytest.approx(0.1, abs=1e-4)
    assert np.abs(motion.positions - slip.positions).max() < 1.1e-4


@pytest.fixture
def quickly(monkeypatch):
    """Figures from few instants."""
    monkeypatch.setattr(figures_y, "SAMPLES", 40)
    monkeypatch.setattr(snapshots, "SAMPLES", 41)

    def draw(name):
        content = FIGURES[name]
        if isinstance(content, Lines):
            step = content.case.path.duration / 10.0
            runs = tuple(replace(run, step=step / (1 + k)) for k, run in enumerate(content.runs))
            content = replace(content, runs=runs)
        return figures_y.draw(name, content)

    return draw


@pytest.mark.parametrize("name", distinct(Lines))
def test_a_figure_over_time_is_complete(name, quickly):
    """All curves among its numbers, an error beside those that coincide, and all time axes."""
    sheet, content = quickly(name), FIGURES[name]
    for what in content.panels:
        assert what in sheet.columns
        for run in content.runs:
            assert f"{what}, {run.label}" in sheet.columns
            if len(content.runs) > 1:
                assert f"error of {what}, {run.label}" in sheet.columns
    if len(content.runs) == 1:
        assert any(column.startswith("error of") for column in sheet.columns)
    shown = [ax for ax in sheet.figure.axes if ax.get_visible()]
    titles = [ax.get_title(loc="left") for ax in shown]
    for what, symbol in content.panels.items():
        assert any(symbol in title and what in title for title in titles)
    for column in {ax.get_subplotspec().colspan.start for ax in shown}:
        panels = [ax for ax in shown if ax.get_subplotspec().colspan.start == column]
        lowest = max(panels, key=lambda ax: ax.get_subplotspec().rowspan.start)
        assert lowest.get_xlabel() == "time [s]"
        assert lowest.xaxis.get_tick_params()["labelbottom"]
    assert all(ax.get_ylabel() for ax in shown if "over" not in ax.get_title(loc="left"))
    assert sheet.figure.legends
    assert not any(ax.get_legend() for ax in shown)


@pytest.mark.parametrize("name", distinct(Snapshots))
def test_poses_carry_their_times(name, quickly):
    """In every view each pose has its time, inside the picture and on no other time."""
    sheet, duration = quickly(name), FIGURES[name].case.path.duration
    times = sorted(f"{share * duration / 5:.3g} s" for share in range(6))
    sheet.figure.draw_without_rendering()
    for ax in sheet.figure.axes:
        assert sorted(text.get_text() for text in ax.texts) == times
        boxes = [Text.get_window_extent(text) for text in ax.texts]
        frame = ax.get_window_extent()
        for k, box in enumerate(boxes):
            assert not any(box.overlaps(other) for other in boxes[:k])
            assert frame.x0 <= box.x0 <= box.x1 <= frame.x1
            assert frame.y0 <= box.y0 <= box.y1 <= frame.y1


def test_cablevs_figures_say_which_move():
    moves = {"turn": "turn about", "line": "straight line", "line and turn": "line with a turn"}
    for content in FIGURES.values():
        if content.case.name == "cable_manipulator":
            assert moves[content.case.move] in content.title


@pytest.mark.parametrize("name", FIGURES)
def test_captions_say_machine_path_and_comparison(name):
    content, said = FIGURES[name], entries()[name].caption
    assert f"`{content.case.name}`" in said
    for key, value in content.case.overrides:
        assert f"{key} {value:.6g}" in said
    assert f"in {content.case.path.duration:g} s" in said
    if isinstance(content, Lines):
        for run in content.runs:
            assert run.formulation in said.lower()
            assert f"{run.step:g}" in said


def test_the_page_shows_every_entry_with_its_caption():
    page = (Path(flatrig.__file__).parent / "docs" / "reference" / "reproduced.md").read_text()
    for name, entry in entries().items():
        assert entry.caption
        assert f"## {name}: {entry.title}\n\n{entry.caption}\n" in page
