"""Headless scenes carry nothing idle, and what is switched off changes no result, to the bit."""

import copy
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from flatrig import models
from flatrig.models.mjcf import rig_model, simulate
from flatrig.models.mjcf.hand_model import RECOMMENDED, compile_hand
from flatrig.training import cli
from flatrig.training.bench import accuracy, lean

ROPES = ("rigid", "elastic", "slack")
EVERYTHING = sum(lean.OFF.values()) | lean.ALL_CONSTRAINTS


@pytest.fixture(params=[*models.CATALOGUE, "massless"])
def rig(request):
    if request.param == "massless":
        return models.navy_crane_3d(pulley_mass=0.0)
    return models.make(request.param)


def compiled(rig, ropes, **options):
    massless = 1.0 if any(load.mass == 0 for load in rig.loads) else None
    return rig_model.compile(rig, ropes=ropes, massless=massless, **options)


def shaken(model, flags):
    """A tenth of a second about home under changing inputs, with these features switched off."""
    changed = copy.copy(model)
    changed.opt.disableflags = flags
    generator = np.random.default_rng(3)
    ctrl = model.key_ctrl[0] + generator.normal(scale=3.0, size=(100, model.nu))
    speed = generator.normal(scale=0.1, size=model.nv)
    return simulate.run(changed, model.key_qpos[0], speed, ctrl)


def same(one, other):
    return np.array_equal(one.qpos, other.qpos) and np.array_equal(one.qvel, other.qvel)


@pytest.mark.parametrize("ropes", ROPES)
def test_headless_scenes_carry_nothing_idle(rig, ropes):
    assert lean.idle(compiled(rig, ropes, visuals=False)) == []


@pytest.mark.parametrize("ropes", ROPES)
def test_what_is_left_out_changes_nothing_and_what_is_used_does(rig, ropes):
    model = compiled(rig, ropes, visuals=False)
    flags = int(model.opt.disableflags)
    expected = shaken(model, flags)
    idle = sum(bit for name, bit in lean.OFF.items() if name not in lean.used(model))
    if not model.ngravcomp:  # without springs and dampers MuJoCo leaves that out, too
        assert same(shaken(model, flags | idle), expected)
    assert same(shaken(model, flags & ~EVERYTHING), expected)
    for name in lean.used(model):
        assert not same(shaken(model, flags | lean.OFF[name]), expected)


@pytest.mark.parametrize("ropes", ROPES)
def test_looks_and_sensors_change_nothing(rig, ropes):
    bare, dressed = (compiled(rig, ropes, visuals=looks) for looks in (False, True))
    one, other = (shaken(model, int(model.opt.disableflags)) for model in (bare, dressed))
    assert same(one, other)
    assert lean.idle(dressed) != []
    assert mujoco.mj_sizeModel(bare) < 0.05 * mujoco.mj_sizeModel(dressed)


@pytest.fixture(params=[*models.HAND_CATALOGUE])
def hand(request):
    return models.make_hand(request.param)


HEADLESS = [how for how in lean.HAND_VARIANTS.values() if how]


@pytest.mark.parametrize("how", HEADLESS)
def test_headless_hands_carry_nothing_idle(hand, how):
    assert lean.idle(compile_hand(hand, **how)) == []


def squeezed(model, flags):
    """A tenth of a second about home under changing forces, with these features switched off."""
    changed = copy.copy(model)
    changed.opt.disableflags = flags
    generator = np.random.default_rng(5)
    ctrl = model.key_ctrl[0] + generator.normal(scale=0.02, size=(100, model.nu))
    return simulate.run(changed, model.key_qpos[0], np.zeros(model.nv), ctrl)


def test_what_hands_leave_out_changes_nothing_and_contact_does(hand):
    model, dressed = (compile_hand(hand, visuals=looks) for looks in (False, True))
    flags = int(model.opt.disableflags)
    assert flags == int(dressed.opt.disableflags)
    expected = squeezed(model, flags)
    assert same(squeezed(model, flags & ~EVERYTHING), expected)
    assert same(squeezed(dressed, flags), expected)
    assert not same(squeezed(model, flags | lean.OFF["contact"]), expected)
    assert lean.idle(dressed) != []
    assert mujoco.mj_sizeModel(model) < 0.05 * mujoco.mj_sizeModel(dressed)


@pytest.mark.parametrize("cone", ["elliptic", "pyramidal"])
def test_scratch_memory_of_hands_is_ample(hand, cone):
    """With the most rows for each contact, and all fingers touching, it takes less than a tenth."""
    model = compile_hand(hand, replace(RECOMMENDED, condim=6, cone=cone), visuals=False)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data, lean.SETTLING)
    assert data.ncon == len(hand.fingers)
    assert data.nefc == data.ncon * (6 if cone == "elliptic" else 10)
    assert 0 < data.maxuse_arena < 0.1 * data.narena


def test_idle_parts_are_named():
    scene = rig_model.spec(models.overhead_crane(), visuals=False)
    scene.add_tendon(name="loose").wrap_joint("load.x", 1.0)
    scene.worldbody.add_geom(name="ball", size=[1, 0, 0])
    scene.option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    found = lean.idle(scene.compile())
    assert found[:2] == ["1 geom", "tendon loose"]
    assert found[2:] == [f"feature {name}" for name in ("equality", "frictionloss", "limit")]


def test_scratch_memory_is_ample():
    """With all constraints on, the largest scene takes less than a tenth of it."""
    model = rig_model.compile(models.cable_manipulator(), visuals=False, friction=True)
    model.tendon_frictionloss[:] = model.dof_frictionloss[:] = 1.0
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data, 10)
    assert data.nefc == model.nv + model.ntendon
    assert 0 < data.maxuse_arena < 0.1 * data.narena


def test_the_table(monkeypatch, capsys):
    monkeypatch.setattr(lean, "CATALOGUE", {"overhead_crane": models.overhead_crane})
    monkeypatch.setattr(lean, "HAND_CATALOGUE", {"ball_on_plate": None})
    monkeypatch.setenv("COLUMNS", "240")
    assert cli.main(["lean"]) == 0
    said = capsys.readouterr().out
    assert all(name in said for name in (*lean.VARIANTS, *lean.HAND_VARIANTS))
    assert "looks, constraints" in said
    assert "looks, all but contact" in said
    wrong = [line for line in said.splitlines() if "wrong" in line and "MJX" not in line]
    assert len(wrong) == len(lean.HAND_VARIANTS) + 1  # and as it is written


def test_every_crane_of_the_catalogue_is_driven_in_mujoco():
    assert {case.rig.name for case in accuracy.cases()} == set(models.CATALOGUE)
    assert set(accuracy.GOALS) <= set(models.CATALOGUE)
