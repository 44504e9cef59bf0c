"""Scenes as XML: a machine for plain MuJoCo, and a scene for viewers that includes it."""

import mujoco
import numpy as np
import pytest

from flatrig import models
from flatrig.models.looks import render, skins
from flatrig.models.mjcf import export, hand_export, rig_model, simulate

CATALOGUE = tuple(models.CATALOGUE)


RIGS = [*models.CATALOGUE, "cantilever", "gantry", "planar navy", "navy", "four falls"]


@pytest.fixture(params=RIGS)
def rig(request, other_rigs):
    return other_rigs.get(request.param) or models.make(request.param)


def stored_scene(name):
    path = export.FOLDER / f"{name}.xml"
    assert path.exists(), "`flatrig scenes` makes it"
    return path


def included(rig):
    """The scene with the machine that it includes."""
    assets = {f"{rig.name}.xml": export.xml(rig).encode()}
    return mujoco.MjModel.from_xml_string(export.scene_xml(rig), assets)


@pytest.mark.parametrize("name", CATALOGUE)
def test_exported_scenes_are_current_and_include_the_machine(name):
    scene = stored_scene(f"{name}_scene")
    assert scene.read_text() == export.scene_xml(models.make(name)), "`flatrig scenes` makes it"
    model = mujoco.MjModel.from_xml_path(str(scene))
    assert [model.camera(k).name for k in range(model.ncam)] == ["overview", "side"]


@pytest.mark.parametrize("name", CATALOGUE)
def test_exported_machines_are_current_and_stand_alone(name, tmp_path, random_states):
    rig, stored = models.make(name), stored_scene(name)
    assert stored.read_text() == export.xml(rig), "`flatrig scenes` makes it anew"
    (tmp_path / "alone.xml").write_text(stored.read_text())
    alone = mujoco.MjModel.from_xml_path(str(tmp_path / "alone.xml"))
    rig_model.check(alone)
    model = rig_model.compile(rig)
    state_of = random_states(rig)
    expected, found = (
        simulate.accelerations(model, *state_of),
        simulate.accelerations(alone, *state_of),
    )
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-15 * abs(expected).max())
    sections = ["compiler", "option", "size", "worldbody", "tendon", "actuator", "sensor"]
    sections += ["keyframe"]
    places = [stored.read_text().index(f"\n  <{section}") for section in sections]
    assert places == sorted(places)


@pytest.mark.parametrize("name", CATALOGUE)
def test_noise_on_the_inputs_raises_no_warning(name):
    model = mujoco.MjModel.from_xml_path(str(stored_scene(name)))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    generator, home = np.random.default_rng(1), model.key("home").ctrl
    spread = 0.1 * model.actuator_ctrlrange[:, 1]
    for _ in range(1000):
        data.ctrl[:] = home + spread * generator.normal(size=model.nu)
        mujoco.mj_step(model, data)
    assert not any(warning.number for warning in data.warning)
    assert np.isfinite(data.qpos).all()


def test_export_writes_to_a_folder(tmp_path):
    written = export.export(tmp_path / "new")
    names = [*CATALOGUE, *models.HAND_CATALOGUE]
    files = [f"{name}{kind}.xml" for name in names for kind in ("", "_scene")]
    assert [path.name for path in written] == files


def test_a_machine_carries_what_a_simulation_needs_and_its_scene_the_looks(rig):
    lean = rig_model.compile(rig, visuals=False)
    machine = mujoco.MjModel.from_xml_string(export.xml(rig))
    scene = included(rig)
    for kind in ("geom", "cam", "light", "mat", "tex", "skin"):
        assert getattr(machine, f"n{kind}") == 0
        assert getattr(scene, f"n{kind}") > 0
    assert machine.nsensor == scene.nsensor > 0
    assert not (scene.geom_contype | scene.geom_conaffinity).any()
    assert machine.nbuffer < 1.2 * lean.nbuffer
    assert mujoco.MjData(machine).narena <= mujoco.MjData(lean).narena + 1024


def test_scene_machine_and_compiled_model_move_alike_to_the_bit(rig):
    lean = rig_model.compile(rig, visuals=False)
    machine, scene = mujoco.MjModel.from_xml_string(export.xml(rig)), included(rig)
    generator = np.random.default_rng(2)
    inputs = lean.key_ctrl[0] + generator.normal(scale=3.0, size=(200, lean.nu))
    speed = generator.normal(scale=0.1, size=lean.nv)
    expected, *others = (
        simulate.run(model, lean.key_qpos[0], speed, inputs) for model in (lean, machine, scene)
    )
    for found in others:
        np.testing.assert_array_equal(found.qpos, expected.qpos)
        np.testing.assert_array_equal(found.qvel, expected.qvel)


def test_skins_are_where_the_geoms_of_the_dressed_model_are(rig):
    dressed, scene = rig_model.compile(rig), included(rig)
    moving = {
        (dressed.body(body).name, dressed.mat(material).name)
        for body, material in zip(dressed.geom_bodyid, dressed.geom_matid, strict=True)
        if body
    }
    drawn = skins.skins(dressed)
    assert {(skin.body, skin.material) for skin in drawn} == moving
    assert {scene.skin(k).name for k in range(scene.nskin)} == {".".join(key) for key in moving}
    assert scene.ngeom == np.count_nonzero(dressed.geom_bodyid == 0)


@pytest.mark.parametrize(
    ("shape", "volume", "reach"),
    [
        ('type="box" size="0.1 0.2 0.3"', 8 * 0.1 * 0.2 * 0.3, (0.1, 0.2, 0.3)),
        # a prism of 16 sides; two of 8 sides, and two frusta with a tip below each
        ('type="cylinder" size="0.1 0.3"', 0.6 * 0.01 * 8 * np.sin(np.pi / 8), (0.1, 0.1, 0.3)),
        (
            'type="capsule" size="0.1 0.3"',
            0.01 * 4 * np.sin(np.pi / 4)
            * (0.6 + 0.2 / 3 * (np.sqrt(0.5) * (1.5 + np.sqrt(0.5)) + 0.5 * (1 - np.sqrt(0.5)))),
            (0.1, 0.1, 0.4),
        ),
    ],
)  # fmt: skip
def test_skins_of_shapes_are_closed_and_face_outwards(shape, volume, reach):
    """Volume by the divergence theorem: right only if every triangle faces outwards."""
    pose = 'pos="1 2 3" quat="0.5 0.5 -0.5 0.5"'
    text = f"<mujoco><worldbody><body><geom {shape} {pose}/></body></worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(text)
    vertices, faces = skins.triangles(model, 0)
    corners = vertices[faces]
    six = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    assert six.sum() / 6 == pytest.approx(volume, rel=1e-9)
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, np.array([0.5, 0.5, -0.5, 0.5]))
    own = (vertices - [1, 2, 3]) @ turn.reshape(3, 3)
    np.testing.assert_allclose(abs(own).max(axis=0), reach, rtol=1e-6)


def test_the_scene_looks_like_the_dressed_model():
    rig = models.navy_crane_3d()
    pictures = []
    for model in (rig_model.compile(rig), included(rig)):
        model.vis.quality.shadowsize = 1024  # the larger one takes seconds without a graphics card
        turned = model.key_qpos[0] + 0.3
        pictures.append(next(render.frames(model, turned[None], [0.0], "overview", 320, 240)))
    one, other = (np.asarray(picture, dtype=float) for picture in pictures)
    floor = np.abs(one - np.median(one, axis=(0, 1))).max(axis=2) > 40
    assert floor.mean() > 0.05  # the crane is in the picture
    assert (np.abs(one - other).max(axis=2) > 40).mean() < 0.01


@pytest.mark.parametrize("name", models.HAND_CATALOGUE)
def test_exported_hands_are_current_and_move_as_compiled_ones_to_the_bit(name):
    hand = models.make_hand(name)
    expected = models.compile_hand(hand, visuals=False)
    generator = np.random.default_rng(3)
    inputs = expected.key_ctrl[0] + generator.normal(scale=0.02, size=(100, expected.nu))
    start = expected.key_qpos[0], np.zeros(expected.nv)
    run = simulate.run(expected, *start, inputs)
    for file, text in (
        (name, hand_export.hand_xml(hand)),
        (f"{name}_scene", hand_export.hand_scene_xml(hand)),
    ):
        assert stored_scene(file).read_text() == text, "`flatrig scenes` makes it anew"
        model = mujoco.MjModel.from_xml_path(str(export.FOLDER / f"{file}.xml"))
        found = simulate.run(model, *start, inputs)
        np.testing.assert_array_equal(found.qpos, run.qpos)
        np.testing.assert_array_equal(found.qvel, run.qvel)
        data = mujoco.MjData(model)
        data.qpos[:] = run.qpos[-1]
        mujoco.mj_forward(model, data)
        np.testing.assert_array_equal(data.sensor("object.position").data, data.body("object").xpos)
        slides = [model.joint(k).name for k in range(model.njnt) if "slide" in model.joint(k).name]
        assert [data.sensor(slide).data[0] for slide in slides] == [
            data.joint(slide).qpos[0] for slide in slides
        ]
        assert (model.ncam > 0) == file.endswith("scene")
