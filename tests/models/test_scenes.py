"""Scenes for people: open-loop runs, cameras, pictures."""

import math
import sys

import mujoco
import numpy as np
import pytest

from flatrig import models
from flatrig.models import Anchor, Drive, ModelError, OptionError, Platform, Rig, Rope
from flatrig.models.looks import booms, render
from flatrig.models.mjcf import rig_model, rig_state, simulate
from flatrig.models.rig.chain import chain_of

CATALOGUE = tuple(models.CATALOGUE)


RIGS = [*models.CATALOGUE, "cantilever", "gantry", "planar navy", "navy", "four falls"]


@pytest.fixture(params=RIGS)
def rig(request, other_rigs):
    return other_rigs.get(request.param) or models.make(request.param)


def test_run_returns_the_start_and_every_step():
    rig = models.rotary_crane()
    model = rig_model.compile(rig, visuals=False)
    home, data = model.key("home"), mujoco.MjData(model)
    controls = home.ctrl + np.random.default_rng(0).normal(size=(50, model.nu))
    speed = np.linspace(-0.1, 0.1, model.nv)
    found = simulate.run(model, home.qpos, speed, controls)
    assert found.qpos.shape == (51, model.nq)
    data.qpos[:], data.qvel[:] = home.qpos, speed
    for k, row in enumerate(controls):
        np.testing.assert_array_equal(found.qpos[k], data.qpos)
        data.ctrl[:] = row
        mujoco.mj_step(model, data)
    np.testing.assert_array_equal(found.qvel[-1], data.qvel)


def test_run_refuses_what_cannot_be():
    model = rig_model.compile(models.overhead_crane(), visuals=False)
    start = model.key("home").qpos, np.zeros(model.nv)
    with pytest.raises(ModelError, match=r"shape \(3, 1\), it must be \(N, 2\)"):
        simulate.run(model, *start, np.zeros((3, 1)))
    with pytest.raises(ModelError, match="not finite at step 1"):
        simulate.run(model, *start, np.array([[0, 0], [np.nan, 0]]))
    with pytest.raises(ModelError, match="breaks down"):
        simulate.run(model, *start, np.full((50, 2), 1e13))
    with pytest.raises(ModelError, match=r"controls is .*, it must be finite numbers"):
        simulate.run(model, *start, "ab")
    still = np.zeros((3, 2))
    with pytest.raises(ModelError, match=r"qpos has shape \(2,\), it must be \(3,\)"):
        simulate.run(model, start[0][:2], start[1], still)
    with pytest.raises(ModelError, match=r"qvel has shape \(1, 3\), it must be \(3,\)"):
        simulate.run(model, start[0], start[1][None], still)
    with pytest.raises(ModelError, match=r"qpos is \[nan, 0.0, 0.0\], it must be finite"):
        simulate.run(model, [np.nan, 0, 0], start[1], still)


def test_accelerations_are_refused_where_mujoco_gives_up():
    model = models.compile(models.overhead_crane(), visuals=False)
    home, still = np.array(model.key_qpos[0]), np.zeros(model.nv)
    with pytest.raises(ModelError, match="state 1 or its inputs are beyond what MuJoCo takes"):
        simulate.accelerations(model, [home] * 2, [still] * 2, [[1.0, 0.0], [1.1e10, 0.0]])


def test_run_without_steps_is_the_start():
    model = rig_model.compile(models.overhead_crane(), visuals=False)
    start = np.array([1.0, 2.0, 3.0])
    found = simulate.run(model, start, 2 * start, np.zeros((0, model.nu)))
    np.testing.assert_array_equal(found.qpos, [start])
    np.testing.assert_array_equal(found.qvel, [2 * start])
    found.qpos[:] = 0
    assert start.all()


def corners_in_picture(model, camera, spots):
    """Whether points lie inside a 4:3 picture of a camera."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    view = model.camera(camera).id
    seen = (np.asarray(spots) - data.cam_xpos[view]) @ data.cam_xmat[view].reshape(3, 3)
    slope = math.tan(math.radians(model.cam_fovy[view] / 2))
    inside = (seen[:, 2] < 0) & (abs(seen[:, 1]) < -slope * seen[:, 2])
    return inside & (abs(seen[:, 0]) < -slope * 4 / 3 * seen[:, 2])


@pytest.mark.parametrize("camera", ["overview", "side"])
def test_cameras_see_the_whole_workspace(rig, camera):
    model = rig_model.compile(rig)
    qpos = np.array([value for link in chain_of(rig) for value in link.home])
    spots = [point[0] for point in rig_state.points(rig, qpos, np.zeros_like(qpos)).values()]
    if rig.name in CATALOGUE:
        move = models.default_move(rig.name)
        part = (*rig.platforms, *rig.loads)[-1].name
        for end in (move.start, move.goal):
            place = dict(zip(rig.outputs, end, strict=True))
            spots.append(np.array([place.get(f"{part}.{axis}", 0.0) for axis in "xyz"]))
    for rail in rig.rails:
        if math.isfinite(rail.start) and rig.frame(rail.frame) is None:
            spots += [
                np.add(rail.origin, np.multiply(end, rail.direction))
                for end in (rail.start, rail.end)
            ]
    if rig.name == "rotary_crane":
        circle = np.linspace(0, 2 * np.pi, 24)
        spots += [np.array([8 * np.cos(a), 8 * np.sin(a), z]) for a in circle for z in (0, -5)]
    assert corners_in_picture(model, camera, spots).all()


def test_winches_in_an_inclined_line_stand_on_a_boom(other_rigs):
    (turning,) = booms.find(models.navy_crane_3d())
    assert (turning.frame, turning.anchors) == ("boom", ("A", "P", "S"))
    np.testing.assert_allclose(turning.foot, 0.0, atol=1e-12)  # on the axis
    np.testing.assert_allclose(turning.tip, [7.5 * math.sqrt(3), 0.0, 7.5])
    (fixed,) = booms.find(models.navy_crane_2d(pulley_mass=0.0))
    assert (fixed.frame, fixed.anchors) == ("world", ("A", "P"))
    np.testing.assert_allclose(
        fixed.foot, np.multiply(1.3, models.navy_crane_2d(pulley_mass=0.0).anchors[0].position)
    )
    for name in ("cantilever", "gantry"):
        assert not booms.find(other_rigs[name])  # their winches stand on a beam
    assert not booms.find(cable_robot())


def cable_robot():
    """A platform on three winches that stand alone, on masts of different heights."""
    places = ((-3.0, -2.0, 0.0), (3.0, -2.0, 0.5), (0.0, 3.0, 1.0))
    plate = Platform("plate", 5.0, (0.1, 0.1, 0.2))
    ropes = tuple(Rope(f"rope{k}", (f"winch{k}", f"corner{k}"), 0.1, 0.1) for k in range(3))
    return Rig(
        name="cable_robot",
        anchors=(
            *(Anchor(f"winch{k}", place) for k, place in enumerate(places)),
            *(Anchor(f"corner{k}", np.multiply(0.2, p), "plate") for k, p in enumerate(places)),
        ),
        masses=(plate,),
        ropes=ropes,
        drives=tuple(Drive(rope.name, rope.name, 10.0) for rope in ropes),
        outputs=("plate.x", "plate.y", "plate.z"),
        home={"plate": (0.0, 0.0, -4.0)},
    )


def test_winches_alone_stand_on_masts_and_a_platform_shows_its_corners():
    model = rig_model.compile(cable_robot())
    names = {model.geom(k).name for k in range(model.ngeom)}
    assert {"winch0.mast", "winch1.mast", "winch2.mast"} <= names
    assert {"plate.tube1.2", "plate.tube1.3", "plate.tube2.3", "corner0.eye"} <= names
    floor = model.geom("floor").pos[2]
    mast = model.geom("winch2.mast")
    assert mast.pos[2] - mast.size[1] == pytest.approx(floor, abs=1e-3)


@pytest.fixture
def drawing():
    try:
        return render.backend()
    except ModelError as error:
        pytest.skip(str(error))


def test_pictures(drawing, tmp_path):
    rig = models.rotary_crane()
    model = rig_model.compile(rig)
    turned = rig_state.joint_state(
        rig,
        model,
        {
            "bridge.angle": [0.0, 1.0],
            "trolley.position": [5.0, 5.0],
            "load.x": [5.0, 5 * math.cos(1)],
            "load.y": [0.0, 5 * math.sin(1)],
            "load.z": [-5.0, -3.0],
        },
    )
    images = list(render.frames(model, turned.qpos, [0.0, 1.0], "side", 160, 120, fps=2.0))
    assert [image.shape for image in images] == [(120, 160, 3)] * 3
    assert all(image.dtype == np.uint8 and image.std() > 10 for image in images)
    assert (images[0] != images[2]).any()
    saved = render.save_animation(tmp_path / "crane.gif", images, fps=2.0)
    from PIL import Image

    with Image.open(saved) as animation:
        assert animation.n_frames == 3
        assert animation.info["duration"] == 500
    with pytest.raises(ModelError, match="no camera 'top', it has overview, side"):
        next(render.frames(model, turned.qpos, [0.0, 1.0], "top"))


def test_pictures_refuse_what_cannot_be(tmp_path):
    with pytest.raises(OptionError, match=r"ending must be \.gif or \.mp4"):
        render.save_animation(tmp_path / "crane.avi", [])
    with pytest.raises(OptionError, match="no picture"):
        render.save_animation(tmp_path / "crane.gif", [])
    assert not list(tmp_path.iterdir())
    model = rig_model.compile(models.overhead_crane())
    with pytest.raises(OptionError, match=r"qpos has shape \(2, 2\), it must be \(2, 3\)"):
        next(render.frames(model, np.zeros((2, 2)), [0.0, 1.0]))
    for times in ([], 1.0):
        with pytest.raises(OptionError, match=r"times have shape .*, they need shape \(N,\)"):
            next(render.frames(model, np.zeros((0, 3)), times))
    with pytest.raises(OptionError, match="times must rise"):
        next(render.frames(model, np.zeros((2, 3)), [1.0, 0.0]))
    with pytest.raises(OptionError, match="must be finite"):
        next(render.frames(model, np.zeros((2, 3)), [0.0, np.nan]))
    with pytest.raises(OptionError, match="must be finite numbers"):
        next(render.frames(model, np.zeros((2, 3)), [0.0, "b"]))
    for fps in (0, -1, math.inf, math.nan, 1e-300, "25"):
        with pytest.raises(OptionError, match=rf"fps is {fps!r}, it must be > 0"):
            next(render.frames(model, np.zeros((2, 3)), [0.0, 1.0], fps=fps))
        with pytest.raises(OptionError, match=rf"fps is {fps!r}, it must be > 0"):
            render.save_animation(tmp_path / "crane.gif", [np.zeros((8, 8, 3), np.uint8)], fps=fps)
    assert not list(tmp_path.iterdir())
    with pytest.raises(OptionError, match="4000 x 480"):
        render.renderer(model, 4000, 480)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have a backend of their own")
def test_no_backend_is_one_clear_line(monkeypatch):
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(render, "_works", lambda name: False)
    monkeypatch.setattr(render, "_imported", lambda name: False)
    with pytest.raises(ModelError, match="install one of them"):
        render.backend.__wrapped__()
