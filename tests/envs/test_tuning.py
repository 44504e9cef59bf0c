"""Gains that follow from the rig: the inertia they are made of, and what they hold against."""

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.envs.crane.plan import feedforward_with, make_plan
from flatrig.envs.crane.task import CraneTask
from flatrig.envs.crane.tuning import TUNING, gains_along, gains_of, inertia_matrices, kind_of
from flatrig.envs.laws import task_of

OVERHEAD, ROPED, ROTARY = list(envs.ENVIRONMENTS)[:3]
SHORT = feedforward.rest_to_rest((0, -4), (1, -3), 2.5)


def plant_of(name, **options):
    return task_of(gym.make(name, **options)).plant


def test_drives_alone_at_home_move_what_hangs_on_them():
    """The overhead crane's drives move the trolley, 10 kg, and the load with the winch, 110 kg."""
    gains = gains_of(plant_of(OVERHEAD))
    assert gains.stiffness == pytest.approx(8.6**2 * np.array([10.0, 110.0 * 0.1]))
    assert gains.damping == pytest.approx(1.2 * 8.6 * np.array([10.0, 110.0 * 0.1]))
    heavy = plant_of(OVERHEAD, rig=models.overhead_crane(load_mass=200.0, trolley_mass=20.0))
    assert gains_of(heavy).stiffness == pytest.approx(8.6**2 * np.array([20.0, 210.0 * 0.1]))
    inertia = 480.0 + 10.0 * 5.0**2
    assert gains_of(plant_of(ROTARY)).stiffness[0] == pytest.approx(3.0**2 * inertia)


def test_drives_of_one_trolley_feel_each_other():
    """Pull and hoist turn a drum of 10 kg each, draw a trolley of 10 kg, and share 100 kg."""
    plant = plant_of(ROPED)
    expected = [[120.0, 100.0], [100.0, 110.0]]
    matrix = inertia_matrices(plant, plant.home[None])[0]
    assert np.abs(matrix) == pytest.approx(np.array(expected))


def test_a_slanting_rope_makes_the_trolley_carry_the_load():
    """With the rope turned by an angle a the trolley meets 10 + 100 sin^2 a, the winch 110 kg."""
    plant = plant_of(OVERHEAD)
    joints = plant.home.copy()
    drives = plant.drives_at(joints)
    length, angle = drives[1], 0.3
    state = {"trolley.position": 0.0, "load.x": length * np.sin(angle)}
    state |= {"load.z": -length * np.cos(angle)}
    joints = np.asarray(models.mjcf.rig_model.joint_state(plant.rig, plant.model, state).qpos)
    sine = np.sin(angle)
    # Of one unit of the winch's rope, the load takes all that its own direction is.
    expected = np.array([[10.0 + 100.0 * sine**2, 100.0 * sine], [100.0 * sine, 110.0]])
    assert np.abs(inertia_matrices(plant, joints.reshape(1, -1))[0]) == pytest.approx(expected)


@pytest.mark.parametrize("name", models.CATALOGUE)
def test_every_common_motion_has_the_frequencies_that_are_tuned(name):
    """Eigenvalues of C^-1 K: about the tuned squares, whose product is exactly theirs."""
    task = CraneTask(name)
    plan, drives = task.planner.fixed, len(task.limits)
    forces = task.plant.model.actuator_gear[:, 0] * task.limits
    gains = gains_along(task.plant, plan)[::40] * forces[:, None]
    coordinates = {key: values[::40] for key, values in plan.course.items()}
    joints = models.mjcf.rig_model.joint_state(task.rig, task.plant.model, coordinates).qpos
    inertia = inertia_matrices(task.plant, np.asarray(joints))
    tuned = np.array([TUNING["moving"][kind_of(task.rig.driven(d))][0] for d in task.rig.drives])
    open_tensions = drives - task.plant.model.nv
    if open_tensions > 0:  # of more ropes than freedoms what cannot move has no frequency
        mobility = np.linalg.pinv(inertia, rcond=1e-10, hermitian=True)
        squares = np.sort_complex(np.linalg.eigvals(mobility @ gains[:, :, :drives]))
        assert np.abs(squares[:, :open_tensions]).max() < 1e-9 * tuned.min() ** 2
        squares, tuned = squares[:, open_tensions:], tuned[open_tensions:]
    else:
        squares = np.linalg.eigvals(np.linalg.solve(inertia, gains[:, :, :drives]))
    assert np.prod(squares, axis=1).real == pytest.approx(np.prod(tuned**2))
    assert np.abs(squares.imag).max() < 1e-6
    assert squares.real.max() < 1.1 * tuned.max() ** 2
    assert squares.real.min() > 0.9 * tuned.min() ** 2


@pytest.mark.parametrize("name", models.CATALOGUE)
def test_a_load_that_is_15_percent_heavier_moves_no_drive_by_20_mm_at_rest(name):
    rig, move = models.make(name), models.default_move(name)
    plan = make_plan(rig, feedforward.from_move(move), 0.02, 1.0)
    plant, drives = CraneTask(rig).plant, len(rig.drives)
    missing = feedforward_with(rig, plan, 1.15) - feedforward_with(rig, plan, 1.0)
    for row in (0, -1):
        stiffness = gains_along(plant, plan)[row, :, :drives]
        # The least squares count where ropes are more than freedoms.
        moved = np.abs(np.linalg.lstsq(stiffness, missing[row], rcond=1e-10)[0])
        falls = [getattr(rig.driven(drive), "falls", 1) for drive in rig.drives]
        assert (moved / falls).max() < 0.02  # rope of a block on several falls moves it less


@pytest.mark.parametrize("name", [OVERHEAD, ROPED])
def test_so_it_does_in_the_plant(name):
    env = envs.Feedforward(envs.PD(gym.make(name, reference=SHORT, timestep=1e-2, hold=14.0)))
    env.reset(seed=0, options={"scenario": envs.Scenario(load_mass=1.15)})
    over = False
    while not over:
        *_, terminated, over, _ = env.step(np.zeros(2))
        assert not terminated
    task = task_of(env)
    errors = np.abs(task.encoders.errors[0, :2])
    stiffness = task.gains().schedule.of(task.plans[0])[-1, :, :2]
    missing = feedforward_with(task.rig, task.plans[0], 1.15)[-1] - task.rows.goal_inputs[0]
    assert errors.max() < 0.02
    assert errors == pytest.approx(np.abs(np.linalg.solve(stiffness, missing)), abs=1e-3)


def test_own_gains_are_taken_as_they_are():
    env = envs.PD(gym.make(OVERHEAD), stiffness=(30.0, 4.0))
    assert env.law.schedule is None
    task = task_of(env)
    gains = np.array((30.0, 4.0, *gains_of(task.plant).damping)) / np.tile(task.limits, 2)
    assert env.law.gains == pytest.approx(gains)


def test_at_a_set_point_drives_of_one_trolley_are_softer():
    """Moved alone, pull and hoist meet 120 and 110 kg; 100 kg they share."""
    quickest = 1.0 - 100.0 / np.sqrt(120.0 * 110.0)
    stiffness = gains_of(plant_of(ROPED), "set point").stiffness
    assert stiffness == pytest.approx(3.0**2 * np.array((12.0, 11.0)) * 2.0 * quickest)
    assert gains_of(plant_of(ROTARY), "set point").stiffness[2] == pytest.approx(3.0**2 * 11.0)
