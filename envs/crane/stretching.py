"""Ropes that stretch, or go slack, in environments: where they begin, and what time steps bear.

At rest a winch's torque u holds its rope, T = -u / r: by so much the rope is stretched where an
episode begins.  What no winch drives begins without stretch.
"""

from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from ...models.arguments import keywords_of, known_keywords
from ...models.errors import OptionError
from ...models.mjcf import spools
from ...models.mjcf.rig_state import State, coordinates, joint_state, tensions
from ...models.mjcf.ropes import Ropes, ropes_of
from ...models.rig.rig import Rig
from ...models.types import Array
from ...models.values import shown

BEARABLE = 2.8
"""Largest frequency of a spring times the time step that RK4 bears."""


def given_ropes(option: Any) -> str | Ropes:
    """The option `ropes`: a word, `Ropes`, or from a spec in JSON their fields by name.

    Raises
    ------
    OptionError
        It is none of these, or a field is unknown.
    """
    if isinstance(option, Mapping):
        known_keywords("ropes have no", option, keywords_of(Ropes), OptionError)
        return Ropes(**option)
    if not isinstance(option, str | Ropes):
        raise OptionError(f"ropes is {shown(option)}, it must be a word or models.Ropes")
    return option


class Stretching:
    """The ropes of a rig's model, which may have others than rigid ones.

    Raises
    ------
    OptionError
        They give way, and a winch has a gear that loses power.
    """

    def __init__(self, rig: Rig, ropes: str | Ropes) -> None:
        self._rig, self._ropes = rig, ropes_of(ropes, rig)
        self.slackens = self._ropes.kind == "slack"
        """Whether ropes can go slack."""
        self.stretches = self._ropes.kind in ("elastic", "slack")
        """Whether they give way at all."""
        for drive in rig.drives if self.stretches else ():
            if drive.efficiency != 1.0 and drive.on in rig.rope_names:
                raise OptionError(
                    f"drive {drive.name}: its gear has efficiency {drive.efficiency:g}, and loses "
                    f"nothing with {self._ropes.kind} ropes; take rigid ones, or efficiency = 1"
                )

    def check(self, model: mujoco.MjModel) -> None:
        """Refuse springs that the time step is too long for.

        Raises
        ------
        OptionError
            With the longest time step.
        """
        rig, ropes = self._rig, self._ropes
        if not self.stretches or not all(ropes.spring(rig, rope) for rope in rig.ropes):
            return
        fastest = float(spools.frequencies(rig, model).max())
        if fastest * model.opt.timestep > BEARABLE:
            raise OptionError(
                f"timestep is {model.opt.timestep:g} s, with these {ropes.kind} ropes it "
                f"must be below {BEARABLE / fastest:.2g} s; or take softer ropes, "
                'Ropes("elastic", stiffness=...)'
            )

    def at_rest(self, model: mujoco.MjModel, place: dict[str, float], inputs: Array) -> Array:
        """Joints (nq,) where a rig stands still under inputs (drives,) [N, N m]."""
        joints = np.asarray(joint_state(self._rig, model, place).qpos)
        if not self.stretches:
            return joints
        still = np.zeros_like(joints)
        pulls = tensions(self._rig, joints, still, still, inputs, 0.0)[: len(self._rig.ropes)]
        return np.asarray(joint_state(self._rig, model, place, tensions=np.maximum(pulls, 0)).qpos)

    def moved(self, model: mujoco.MjModel, joints: Array, place: dict[str, Array]) -> Array:
        """Joints (nq,) elsewhere, ropes stretched as at `joints`."""
        there = np.asarray(joint_state(self._rig, model, place).qpos[0])
        if self.stretches:
            here = coordinates(self._rig, model, State(joints[None], np.zeros_like(joints[None])))
            ropes = len(self._rig.ropes)
            loose = joint_state(self._rig, model, here[0]).qpos[0]
            there[-ropes:] += joints[-ropes:] - loose[-ropes:]
        return there
