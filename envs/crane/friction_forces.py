"""Friction of winches, trolleys and frames, and what of it acts along ropes.

Dry friction is MuJoCo's `frictionloss` on tendons and joints: it sticks.  With static friction
above Coulomb's (Stribeck, K remark 31) its bound follows the speed substep by substep, as
`flatrig.models.friction` has it.  Viscous friction is MuJoCo's damping, exact with RK4.  What a
scenario has comes on top of what the rig is described with.

The force of dry friction is exact but for one case.  MuJoCo's batch tells the sum of all friction
on a joint; where a rope and a trolley rub on the same one, as the rope that pulls the roped
crane's trolley does, the sum is shared in proportion to what each can bear, a and b.  That is exact
while both slip, since they slip together; while they stick, the tension is off by at most
2 a b / (a + b).  Where more ropes rub than there are joints, each friction follows from MuJoCo's
own law.
"""

import mujoco
import numpy as np
from mujoco.batch import Batch

from ...models.mjcf.ropes import spool, stretch_of
from ...models.rig.chain import joint_names
from ...models.rig.rig import Rig
from ...models.types import Array
from ..formulas import Formulas, Value, row_sum
from .disturbances import Scenario
from .gear_losses import gears_of
from .small_systems import solved

FAINT = 1e-9
"""Regularisation of the split of friction among drives that rub on the same joint [N]: drives that
cannot bear anything get nothing, and the matrix of the split stays regular."""

SOFTEST, HARDEST = 1e-4, 0.9999
"""Between which MuJoCo keeps impedances (mjMINIMP, mjMAXIMP)."""


PLACES = 8
"""Where it is tried which joints move a tendon."""

Slopes = dict[int, Value]
"""How far a unit of each joint moves what rubs, by the joint; none where it does not."""

UNBOUNDED = 1e12
"""What an equality that holds a rope can bear [N]."""


class Places:
    """Where a rig's drives rub: tendons and joints of its model."""

    def __init__(self, rig: Rig, model: mujoco.MjModel) -> None:
        tendons = {model.tendon(index).name: index for index in range(model.ntendon)}
        drives = [drive.on for drive in rig.drives]
        trolleys = [trolley.coordinate for trolley in rig.trolleys]
        self.ropes = [tendons[rope.name] for rope in rig.ropes]
        driven = [rope for rope in rig.ropes if rope.name in drives]
        self.loose = gives_way(rig, model)
        """Whether ropes stretch, so that winches rub by themselves: on the joints of spools."""
        self.winches = [] if self.loose else [tendons[rope.name] for rope in driven]
        self.spools = [_freedom(model, spool(rope)) for rope in rig.ropes] if self.loose else []
        self.turned = [_freedom(model, spool(rope)) for rope in driven] if self.loose else []
        self.sums = [tendons[name] for name in trolleys if name in tendons]
        self.slides = [_freedom(model, name) for name in trolleys if name not in tendons]
        self.frames = [_freedom(model, frame.coordinate) for frame in rig.frames]


def gives_way(rig: Rig, model: mujoco.MjModel) -> bool:
    """Whether a model has ropes that give way, and spools therefore."""
    held = {model.tendon(int(tendon)).name for tendon in model.eq_obj1id}
    spooled = model.nq > len(joint_names(rig))
    return bool(spooled and not any(stretch_of(rope) in held for rope in rig.ropes))


def slopes(model: mujoco.MjModel) -> list[dict[int, int]]:
    """For each tendon the joints that change its length, and where `ten_J` says how much.

    MuJoCo keeps room for all joints between the bodies that it touches; those that have no part at
    several places have none.
    """
    data, draw = mujoco.MjData(model), np.random.default_rng(0)
    parts = np.zeros(len(data.ten_J), bool)
    for _ in range(PLACES):
        data.qpos[:] = model.key_qpos[0] + draw.uniform(-0.1, 0.1, model.nq)
        mujoco.mj_fwdPosition(model, data)
        parts |= data.ten_J != 0.0
    rows = zip(model.ten_J_rowadr.tolist(), model.ten_J_rownnz.tolist(), strict=True)
    joints = model.ten_J_colind.tolist()
    return [
        {joints[at]: at for at in range(first, first + count) if parts[at]} for first, count in rows
    ]


def _freedom(model: mujoco.MjModel, joint: str) -> int:
    return int(model.joint(joint).dofadr[0])


class DryFriction:
    """Coulomb and static friction of winches, trolleys and, if they are to rub, frames; gears."""

    def __init__(self, rig: Rig, model: mujoco.MjModel, batch: Batch, frames: bool) -> None:
        num, freedoms = batch.nsim, model.nv
        self._at = at = Places(rig, model)
        self._tendons = at.sums if at.loose else at.ropes + at.sums
        self._held = [int(tendon) for tendon in model.eq_obj1id]
        """Tendons that an equality or a limit holds, whose forces are no friction."""
        self._held += np.flatnonzero(model.tendon_limited).tolist()
        self._slides = at.spools + at.slides + (at.frames if frames else [])
        first = len(self._tendons) if at.loose else 0
        self._of_ropes = slice(first, first + len(at.ropes))
        self._on_tendon = batch.expand("tendon_frictionloss")
        self._on_joint = batch.expand("dof_frictionloss")
        self._rates, self._speeds = batch.bind("ten_velocity"), batch.bind("qvel")
        self._gears, self._ctrl = gears_of(rig, model), batch.bind("ctrl")
        self.falling = bool(self._gears)
        """Whether some of it changes with speed, so that `follow` must be called."""
        self._described = (model.tendon_frictionloss.copy(), model.dof_frictionloss.copy())
        self._coulomb = (np.array(self._on_tendon), np.array(self._on_joint))
        self._surplus, self._falling = np.zeros((num, 1)), np.ones((num, 1))
        self._force, self._sparse = batch.bind("qfrc_constraint"), batch.bind("ten_J")
        self._slopes = slopes(model)
        self._crowded = None
        if len(self._tendons) + len(self._slides) + len(self._held) > freedoms:
            self._crowded = SoftFriction(model, batch, self._tendons, self._slides)

    @property
    def memory(self) -> tuple[Array, ...]:
        """Bounds at the speeds of the last substep, (n, ...) each."""
        return self._on_tendon, self._on_joint

    def set(self, sim: int, scenario: Scenario) -> None:
        """Friction of one simulation."""
        at, (on_tendon, on_joint) = self._at, self._coulomb
        on_tendon[sim], on_joint[sim] = self._described
        on_tendon[sim, at.winches] += scenario.winch_friction
        on_joint[sim, at.turned] += scenario.winch_friction
        on_tendon[sim, at.sums] += scenario.trolley_friction
        on_joint[sim, at.slides] += scenario.trolley_friction
        on_joint[sim, at.frames] += scenario.frame_friction
        self._on_tendon[sim], self._on_joint[sim] = on_tendon[sim], on_joint[sim]
        self._surplus[sim] = scenario.static_friction - 1.0
        self._falling[sim] = scenario.stribeck_velocity
        self.falling = bool(self._gears) or bool(self._surplus.any())

    def follow(self) -> None:
        """Bounds at the present speeds: static friction near rest, Coulomb's beyond, and gears."""
        speeds = (self._rates, self._speeds)
        for bound, coulomb, speed in zip(
            (self._on_tendon, self._on_joint), self._coulomb, speeds, strict=True
        ):
            surplus = self._surplus * np.exp(-((speed / self._falling) ** 2))
            np.multiply(coulomb, 1.0 + surplus, bound)
        for gear in self._gears:
            inputs = self._ctrl[:, gear.drive]
            if gear.tendon is not None:
                lost = gear.lost(inputs, self._rates[:, gear.tendon])
                self._on_tendon[:, gear.tendon] += lost
            else:
                lost = gear.lost(inputs, self._speeds[:, gear.freedom])
                self._on_joint[:, gear.freedom] += lost

    def along(self, step: Formulas) -> Value:
        """Force of friction along each rope, (n, ropes) [N]; negative while it is paid out.

        Where a rope and a trolley rub on the same joint they share its friction, see the module.
        """
        moving = [
            {joint: step.see(self._sparse, [at]) for joint, at in self._slopes[tendon].items()}
            for tendon in (*self._tendons, *self._held)
        ]
        slides = [{slide: step.constant(1.0)} for slide in self._slides]
        rubbing = moving[: len(self._tendons)] + slides + moving[len(self._tendons) :]
        bearable = step.join((
            step.see(self._on_tendon, self._tendons),
            step.see(self._on_joint, self._slides),
            step.constant([UNBOUNDED] * len(self._held)),
        ))  # fmt: skip
        if self._crowded is not None:
            free = len(rubbing) - len(self._held)
            return self._crowded.along(step, rubbing[:free], bearable[:free])[self._of_ropes]
        return self._shared(step, rubbing, bearable)

    def _shared(self, step: Formulas, rubbing: list[Slopes], bearable: Value) -> Value:
        """Each rope's share of the friction on its joints."""
        size, faint = len(self._speeds[0]), step.constant(FAINT)
        force = step.see(self._force)
        none = step.constant(0.0)
        along = [row_sum({j: one[j] * force[[j]] for j in one}, size) for one in rubbing]
        pairs = [[none] * len(rubbing) for _ in rubbing]
        for i, one in enumerate(rubbing):
            for k, other in enumerate(rubbing[: i + 1]):
                if common := {j: one[j] * other[j] for j in one if j in other}:
                    pairs[i][k] = pairs[k][i] = row_sum(common, size)
            pairs[i][i] = pairs[i][i] + faint / (bearable[[i]] + faint)
        if all(pairs[i][k] is none for i in range(len(rubbing)) for k in range(i)):
            shares = [one / row[i] for i, (one, row) in enumerate(zip(along, pairs, strict=True))]
        else:
            shares = solved(step, pairs, along)
        return step.join(shares[self._of_ropes])


def along_each(values: Array, out: Array) -> None:
    """Write products (n, m) of matrices with vectors behind them (n, m k + k)."""
    size = values.shape[1] // (out.shape[1] + 1)
    np.matvec(values[:, :-size].reshape(-1, out.shape[1], size), values[:, -size:], out)


class SoftFriction:
    """MuJoCo's law of each friction by itself, for more that rubs than there are joints.

    A constraint of friction has the force -(J qacc + b J qvel) / R within its bounds, with b and R
    from its `solref` and `solimp` and its inverse weight, as MuJoCo's documentation has them
    (Computation, constraint model).
    """

    def __init__(
        self, model: mujoco.MjModel, batch: Batch, tendons: list[int], slides: list[int]
    ) -> None:
        self._tendons, self._slides = tendons, slides
        solref = np.concatenate((model.tendon_solref_fri[tendons], model.dof_solref[slides]))
        solimp = np.concatenate((model.tendon_solimp_fri[tendons], model.dof_solimp[slides]))
        time = np.maximum(solref[:, 0], 2.0 * model.opt.timestep)
        least, most = np.clip(solimp[:, :2].T, SOFTEST, HARDEST)
        self._damping = 2.0 / (most * time)
        self._softness = (1.0 - least) / least
        self._of_tendons = batch.expand("tendon_invweight0")
        self._of_joints = batch.expand("dof_invweight0")
        self._speeds, self._accelerations = batch.bind("qvel"), batch.bind("qacc")

    def along(self, step: Formulas, rubbing: list[Slopes], bearable: Value) -> Value:
        """Of everything that rubs, (n, rubbing)."""
        none, freedoms = step.constant(0.0), self._speeds.shape[1]
        slopes = step.join([one.get(joint, none) for one in rubbing for joint in range(freedoms)])
        rates, growing = (
            step.apply(along_each, step.join((slopes, step.see(motion))), len(rubbing))
            for motion in (self._speeds, self._accelerations)
        )
        missing = growing + step.constant(self._damping) * rates
        weights = (
            step.see(self._of_tendons, self._tendons), step.see(self._of_joints, self._slides),
        )  # fmt: skip
        soft = step.constant(self._softness) * step.join(weights)
        return (-missing / soft).largest(-bearable).least(bearable)


class ViscousFriction:
    """Friction in proportion to speed; made where the rig or some scenario has any."""

    def __init__(self, rig: Rig, model: mujoco.MjModel, batch: Batch) -> None:
        self._at = Places(rig, model)
        self._on_tendon = batch.expand("tendon_damping")
        self._on_joint = batch.expand("dof_damping")
        self._described = (model.tendon_damping.copy(), model.dof_damping.copy())
        self._rates, self._speeds = batch.bind("ten_velocity"), batch.bind("qvel")

    def set(self, sim: int, scenario: Scenario) -> None:
        """Friction of one simulation."""
        at, on_tendon, on_joint = self._at, self._on_tendon, self._on_joint
        on_tendon[sim], on_joint[sim] = self._described
        on_tendon[sim, at.winches] += scenario.winch_viscous
        on_joint[sim, at.turned] += scenario.winch_viscous
        on_tendon[sim, at.sums] += scenario.trolley_viscous
        on_joint[sim, at.slides] += scenario.trolley_viscous
        on_joint[sim, at.frames] += scenario.frame_viscous

    def along(self, step: Formulas) -> Value:
        """Force along each rope, (n, ropes) [N]; negative while it is paid out."""
        ropes, spools = self._at.ropes, self._at.spools
        if spools:
            return -step.see(self._on_joint, spools) * step.see(self._speeds, spools)
        return -step.see(self._on_tendon, ropes) * step.see(self._rates, ropes)
