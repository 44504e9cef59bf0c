"""`flatrig render`: what is in pictures, where cameras stand, what files hold."""

from dataclasses import replace
from functools import cache
from itertools import pairwise

import mujoco
import numpy as np
import pytest
from PIL import Image

from flatrig import envs, feedforward, models
from flatrig.envs.crane.payloads import payload_bodies
from flatrig.models.errors import FlatrigError, ModelError, OptionError
from flatrig.models.looks import marks, render
from flatrig.models.looks.views import Pose, Views, carried_geoms
from flatrig.models.mjcf import rig_model, rig_state
from flatrig.models.rig.idealised import with_ideal_gears
from flatrig.training.cli import main
from flatrig.training.compare.chosen import chosen, scenario_of
from flatrig.training.film import takes
from flatrig.training.film.captions import BLUE, RED, Bar, Sheet, in_units, round_length
from flatrig.training.film.filming import Film, Look
from flatrig.training.simulate.open_loop import stand_in

ASPECT = 4 / 3
SHORT = ["--goal", "0.3", "-4.1", "--duration", "1"]


@pytest.fixture
def drawing():
    try:
        return render.backend()
    except ModelError as error:
        pytest.skip(str(error))


@cache
def planned(name, count=5):
    """A rig's model with looks, and its joints along its own move."""
    rig = models.make(name)
    reference = feedforward.from_move(models.default_move(rig), rig)
    motion = feedforward.solve(rig, reference, np.linspace(0, reference.duration, count))
    model = rig_model.compile(with_ideal_gears(rig), massless=stand_in(rig))
    model.vis.quality.shadowsize = 64  # quick to draw
    values = dict(zip(motion.coordinate_names, motion.positions.T, strict=True))
    return rig, model, rig_state.joint_state(rig, model, values).qpos


def placed(model, joints):
    data = mujoco.MjData(model)
    data.qpos[:] = joints
    mujoco.mj_fwdPosition(model, data)
    return data


def shot_of(name="overhead", aside=0.0, arrival=2.0):
    """The overhead crane at rest, its trolley with all below it beside its place."""
    rig, model, path = planned(name, 2)
    there = path[0].copy()
    there[0] += aside
    take = takes.Take("aside", np.array([0.0, arrival]), np.stack([there, there]))
    still = lambda times: np.tile(path[0], (len(times), 1))  # noqa: E731
    return takes.Shot(rig.name, model, tuple(payload_bodies(rig)), still, (take,), arrival)


@pytest.mark.parametrize("name", models.CATALOGUE)
def test_every_camera_keeps_the_load_in_its_picture(name):
    rig, model, path = planned(name)
    bodies = payload_bodies(rig)
    views = Views(model, path, bodies, ASPECT)
    seen = {camera: views.view(camera) for camera in ("auto", "follow", "top", "orbit")}
    for camera, view in seen.items():
        for share in (0.0, 0.5, 1.0):
            data = placed(model, path[round(share * (len(path) - 1))])
            pose = view.at(share, views.subject(data))
            spots = pose.project(data.xipos[[model.body(body).id for body in bodies]], ASPECT)
            assert np.abs(spots).max() < 0.9, (camera, share)
    assert seen["auto"].hidden[-1] < 0.25  # no tower is before it at the end
    assert seen["follow"].hidden[-1] < 0.25


def test_the_camera_goes_round_a_tower_that_hides_the_load():
    rig, model, path = planned("rotary", 9)
    views = Views(model, path, payload_bodies(rig), ASPECT)
    overview, best = (views.view(name) for name in ("overview", "auto"))
    assert overview.hidden.sum() > 1.0 > best.hidden.sum()
    orbit = [views.view("orbit").at(share, np.zeros(3)).towards for share in (0.0, 1.0)]
    angle = np.degrees(np.arccos(orbit[0][:2] @ orbit[1][:2] / (1 - orbit[0][2] ** 2)))
    assert angle == pytest.approx(100.0)


def test_a_ball_is_drawn_where_it_is_projected(drawing):
    _, model, path = planned("overhead", 2)
    towards = np.array([-0.3, 1.0, -0.32])
    pose = Pose(np.array([3.0, -9.0, 1.0]), towards / np.linalg.norm(towards))
    ball, camera = np.array([1.0, -1.0, -1.0]), mujoco.MjvCamera()
    pose.look(camera)
    model.vis.global_.fovy = 35.0
    with render.renderer(model, 160, 120) as drawn:
        drawn.update_scene(placed(model, path[0]), camera)
        before = np.array(drawn.render(), int)
        marks.ball(drawn.scene, ball, 0.2, (1.0, 0.0, 1.0, 1.0))
        changed = np.abs(np.array(drawn.render(), int) - before).sum(axis=2) > 60
    rows, columns = np.nonzero(changed)
    across, up = pose.project(ball, ASPECT)[0]
    assert np.median(columns) == pytest.approx(80 * (1 + across), abs=3)
    assert np.median(rows) == pytest.approx(60 * (1 - up), abs=3)


def test_the_ghost_is_where_the_reference_is_and_the_error_what_it_is(drawing):
    shot = shot_of(aside=1.5)
    film = Film(shot, Look(width=160, height=120), still=True)
    assert film.away[0] == pytest.approx(1.5)
    place = film._planned[0]
    with film.studio() as studio:
        pose = studio.pose(0.0, film._rows[0][0])
        nothing = film._path[:2] * 0 - [0, 0, 90.0], film._path[:1]
        seen = [
            np.array(studio.picture(pose, film._rows[0][0], ghost, *nothing), int)
            for ghost in (place, film._rows[0][0])
        ]
    changed = np.abs(seen[0] - seen[1]).sum(axis=2) > 40
    rows, columns = np.nonzero(changed)
    crate = placed(shot.model, place).geom_xpos[carried_geoms(shot.model, ["load"])[:1]]
    across, up = pose.project(crate, studio.aspect)[0]
    width, height = changed.shape[1], changed.shape[0]
    assert np.median(columns) == pytest.approx(0.5 * width * (1 + across), abs=4)
    assert np.median(rows) == pytest.approx(0.5 * height * (1 - up), abs=6)


def test_obstacles_are_drawn_where_they_stand(drawing):
    ball = feedforward.Sphere("tank", centre=(2.0, 0.0, -2.0), radius=0.5)
    shot = replace(shot_of(), obstacles=(ball, feedforward.Box("wall", (0, -1, -5), (1, 1, -4))))
    film = Film(shot, Look(width=120, height=90), still=True)
    with film.studio() as studio:
        picture = film._rows[0][0], None, film._path[:1], film._path[:1]
        pose = studio.pose(0.0, picture[0])
        studio.picture(pose, *picture)
        drawn = studio._renderer.scene.geoms[: studio._renderer.scene.ngeom][-2:]
        spots = pose.project(np.array([ball.centre, (0, -1, -5), (1, 1, -4)]), studio.aspect)
    assert np.abs(spots).max() < 1.0
    assert [geom.type for geom in drawn] == [marks.SPHERE, marks.BOX]
    assert np.allclose(drawn[0].pos, ball.centre)
    assert np.allclose(drawn[0].size, 0.5)
    assert np.allclose(drawn[1].pos, (0.5, 0.0, -4.5))
    assert np.allclose(drawn[1].size, (0.5, 1.0, 0.5))


def test_falls_are_as_many_ropes_side_by_side():
    rig, model, path = planned("luffing", 2)
    scene, options, camera = mujoco.MjvScene(model, 3000), mujoco.MjvOption(), mujoco.MjvCamera()
    everything = int(mujoco.mjtCatBit.mjCAT_ALL)
    mujoco.mjv_updateScene(model, placed(model, path[0]), options, None, camera, everything, scene)
    count = scene.ngeom
    counts = {model.tendon(rope.name).id: rope.falls for rope in rig.ropes}
    last = {g.objid: np.array(g.pos) for g in scene.geoms[:count] if g.objtype == marks.TENDON}
    marks.falls(scene, counts)
    assert sorted(counts.values()) == [2, 8]
    assert scene.ngeom == count + 1 + 7
    for tendon, falls in counts.items():
        ropes = [g for g in scene.geoms[: scene.ngeom] if g.objtype == marks.TENDON]
        same = [g for g in ropes if g.objid == tendon][-1:]
        same += [g for g in scene.geoms[count : scene.ngeom] if g.matid == same[0].matid]
        places = np.array([g.pos for g in same])
        assert len(same) == falls
        assert np.allclose(places.mean(axis=0), last[tendon], atol=1e-5)
        gaps = [np.linalg.norm(b - a) for a, b in pairwise(places)]
        assert min(gaps) > 2 * same[0].size[0]
        assert len({tuple(g.size) for g in same}) == 1


def test_few_rods_show_a_line():
    straight = np.linspace([0.0, 0.0, 0.0], [3.0, 1.0, 2.0], 50)
    assert marks.corners(straight, 1e-6) == [0, 49]
    angles = np.linspace(0, np.pi, 200)
    arc = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    kept = marks.corners(arc, 1e-3)
    assert kept == sorted(kept)
    assert (kept[0], kept[-1]) == (0, 199)
    # an arc is 1 - cos(half its angle) off its chord, at most
    widest = max(b - a for a, b in pairwise(kept)) * np.pi / 199
    assert 1 - np.cos(0.5 * widest) <= 1e-3
    assert len(kept) <= 2 * (np.pi / (2 * np.arccos(1 - 1e-3)) + 1)  # halves at worst
    assert marks.corners(np.zeros((9, 3)), 1e-3) == []


def test_somebody_is_as_tall_as_people_are():
    model = models.compile(models.overhead_crane())
    scene = mujoco.MjvScene(model, 100)
    marks.person(scene, (1.0, 2.0, -5.0))
    shapes = scene.geoms[: scene.ngeom]
    balls = [g for g in shapes if g.type == marks.SPHERE]
    rods = [g for g in shapes if g.type == marks.CAPSULE]
    assert max(g.pos[2] + g.size[0] for g in balls) == pytest.approx(-5.0 + 1.8)
    low = min(g.pos[2] - g.size[2] * abs(g.mat[2, 2]) - g.size[0] for g in rods)
    assert low == pytest.approx(-5.0, abs=0.01)


@pytest.mark.parametrize("share", [0.0, 0.25, 0.8])
def test_bars_are_as_long_as_their_numbers(share):
    sheet = Sheet(320, 240, 2)
    width, height = sheet.picture
    picture = np.full((height, width, 3), 128, np.uint8)
    bars = [Bar("error", "3.00 mm", 0.5), Bar("hoist", "-1.0 N", share, wrong=True)]
    whole = sheet.compose(picture, "FF + PD", "0.50 s", (2.0, 50.0), bars, "")
    assert whole.shape == (240, 320, 3)
    below = whole[-sheet.below :, : width - 70]
    lengths = [int((below == colour).all(axis=2).any(axis=0).sum()) for colour in (BLUE, RED)]
    assert lengths[1] == pytest.approx(2 * share * lengths[0], abs=3)
    above, shown = whole[: sheet.above], whole[sheet.above : -sheet.below]
    assert (above[:, :60] < 60).any()  # caption
    assert (above[:, -60:] < 60).any()  # clock
    assert (shown[: height - 3 * sheet.line, :-1] == 128).all()
    dark = (shown[-sheet.letters] < 60).all(axis=1)
    assert dark.sum() == pytest.approx(51, abs=2)  # the length in pixels


def test_numbers_have_units_that_suit_them():
    said = [in_units(*pair) for pair in ((1500.0, "N"), (9.81, "N"), (0.0123, "m"), (2e-5, "m"))]
    assert said == ["1.5 kN", "9.8 N", "12.3 mm", "0.02 mm"]
    assert [round_length(x) for x in (1.0, 1.99, 4.99, 70.0, 0.03)] == [1, 1, 2, 50, 0.02]


def test_a_film_lasts_as_long_as_its_speed_says():
    shot = shot_of(arrival=2.0)
    for speed, fps, count in ((1.0, 25.0, 51), (0.25, 25.0, 201), (2.0, 10.0, 11)):
        film = Film(shot, Look(fps=fps, speed=speed))
        assert film.count == count
        assert film.times[-1] == pytest.approx(2.0)
    with pytest.raises(OptionError, match="200001 pictures, it may have 50000"):
        Film(shot, Look(fps=1e5))


def test_a_hopeless_controller_does_not_hide_how_good_others_are():
    shot = shot_of(aside=0.1)
    rows = shot.takes[0].qpos
    far = np.stack([rows[0], rows[0] + 300.0])
    others = (replace(shot.takes[0], name="too", qpos=rows), replace(shot.takes[0], qpos=far))
    film = Film(replace(shot, takes=(*shot.takes, *others)), Look(), still=True)
    good, bad = (film._bars(film.shot.takes[k], k, 2)[0] for k in (0, 2))
    assert good.share == pytest.approx(0.1 / (1.05 * 0.2))
    assert not good.wrong
    assert bad.share > 1.0
    assert bad.wrong


def test_controllers_are_named_as_in_comparisons():
    rig = models.make("navy-2d")
    named = chosen("PD, set point,ff, lqr,residual,Swing Damping, full", "crane", rig)
    assert [choice.entry.name for choice in named] == [
        "PD, set point", "feedforward", "LQR, sway", "residual, sway", "swing damping, full",
    ]  # fmt: skip
    for text, said in (
        ("ff+pdd", "did you mean ff\\+pd"),
        ("pd,PD, moving", "twice"),
        ("residual,encoders", "no policy is shipped for navy_crane_2d"),
    ):
        with pytest.raises(OptionError, match=said):
            chosen(text, "crane", rig)


def test_scenarios_are_named_numbers():
    made = scenario_of("load_mass=1.2, wind=20,delay=2", envs.Scenario)
    assert made == envs.Scenario(load_mass=1.2, wind=20.0, delay=2)
    assert scenario_of("turn=0:0:0.03", envs.HandScenario).turn == (0.0, 0.0, 0.03)
    for text, said in (
        ("lode_mass=1", "did you mean load_mass"),
        ("wind", "name=number"),
        ("load_mass=0", "> 0"),
    ):
        with pytest.raises(FlatrigError, match=said):
            scenario_of(text, envs.Scenario)


def test_a_take_is_what_an_environment_does():
    rig, move = models.make("overhead"), models.Move((0.0, -4.0), (0.3, -4.1), 1.0)
    scenario = envs.Scenario(load_mass=1.2, wind=20.0)
    shot = takes.crane_shot(rig, move, chosen("pd,ff+pd", "crane", rig), scenario)
    film = Film(shot, Look(fps=50.0))
    env = envs.CraneEnv(rig, reference=move, disturbances="standard", hold=3.0, timestep=5e-3)
    above = envs.Feedforward(envs.PD(env))
    _, info = above.reset(seed=0, options={"scenario": scenario})
    far, pulled = [], []
    while True:
        far.append(np.linalg.norm(info["load"] - info["reference"]))
        pulled.append(float(info["tension"][0]))
        _, _, terminated, truncated, info = above.step([0.0, 0.0])
        if terminated or truncated:
            break
    assert film.away[1][: len(far)] == pytest.approx(far, abs=1e-9)
    assert shot.takes[1].meters[0].values[: len(pulled)] == pytest.approx(pulled, rel=1e-12)
    assert film.away[0].max() > film.away[1].max()


def test_a_film_of_two_controllers(drawing, capsys, tmp_path):
    size = ["--width", "120", "--height", "90", "--fps", "0.5"]
    path = tmp_path / "a.gif"
    argv = ["render", "overhead", "--controller", "pd,ff+pd", "--scenario", "load_mass=1.2,wind=20"]
    assert main([*argv, *SHORT, *size, "-o", str(path)]) == 0
    assert capsys.readouterr().out == f"wrote {path}: 3 pictures, 6 s\n"
    with Image.open(path) as film:
        assert film.size == (240, 90)
        assert film.n_frames == 3
        total = 0
        for k in range(film.n_frames):
            film.seek(k)
            total += film.info["duration"]
    assert total == 6000


def test_a_strip_of_a_hand(drawing, tmp_path):
    path = tmp_path / "a.png"
    size = ["--width", "120", "--height", "90"]
    argv = ["render", "two-finger", "--duration", "0.3", "--controller", "ff+pd"]
    assert main([*argv, *size, "-o", str(path)]) == 0
    with Image.open(path) as strip:
        assert strip.size == (360, 90)


def test_plain_pictures_are_the_scene_alone(drawing):
    film = Film(shot_of(), Look("side", 120, 90, plain=True))
    first = next(film.images())
    own = next(render.frames(film.shot.model, film._planned[:1], [0.0], "side", 120, 90))
    assert np.abs(first.astype(int) - own).mean() < 2.0


def test_an_mp4_lasts_as_long(tmp_path):
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    blank = np.zeros((90, 120, 3), np.uint8)
    path = render.save_animation(tmp_path / "a.mp4", [blank] * 5, 2.0)
    assert ffmpeg.count_frames_and_secs(str(path)) == (5, pytest.approx(2.5))


WRONG = {
    "camera": (["--camera", "tpo"], "did you mean top"),
    "speed": (["--speed", "0"], "--speed is 0, it must be > 0"),
    "controller": (["--controller", "residuel"], "did you mean residual"),
    "scenario": (["--scenario", "lode_mass=1"], "did you mean load_mass"),
    "policy": (["--controller", "residual", "--policy", "nix.json"], "cannot read policy nix.json"),
    "size": (["--height", "20"], "64 to 1920 and 64 to 1080 pixels"),
    "ending": (["-o", "film.avi"], ".gif, .mp4 or .png"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_mistake_gets_one_line(case, capsys):
    argv, said = WRONG[case]
    assert main(["render", "overhead", *argv]) == 2
    err = capsys.readouterr().err
    assert said in err
    assert err.count("\n") == 1


def test_an_unknown_backend_is_named_in_one_line(capsys, monkeypatch):
    def refuse(command):
        raise RuntimeError("invalid value for environment variable MUJOCO_GL: nonsense")

    monkeypatch.setattr("flatrig.training.film.film.of_a_crane", refuse)
    assert main(["render", "overhead"]) == 2
    assert capsys.readouterr().err == (
        "flatrig: error: invalid value for environment variable MUJOCO_GL: nonsense; egl, osmesa "
        "and glfw are some\n"
    )


def test_where_nothing_draws_one_line_says_so(capsys, monkeypatch):
    def fail():
        raise ModelError("cannot draw: neither EGL nor OSMesa works here")

    monkeypatch.setattr(render, "backend", fail)
    assert main(["render", "overhead"]) == 2
    assert capsys.readouterr().err.startswith("flatrig: error: cannot draw")
