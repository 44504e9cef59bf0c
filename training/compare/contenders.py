"""The controllers that `flatrig compare` sets side by side, each registered once.

    @contender("FF + PD + friction")
    def with_friction(env):
        return FrictionCompensation(Feedforward(PD(env)))

A contender wraps a vector environment; its rows in the table, the CSV and the figure follow.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from ...envs import (
    LQR,
    PD,
    PID,
    Feedforward,
    FrictionCompensation,
    MassEstimate,
    Observer,
    PoseFeedback,
    Shaper,
    SwingDamping,
    TautGuard,
)
from ..learned import LearnedResidual, base_controller
from ..policy import Policy

EVALUATION_SEED = 2016_2001
"""Seed of the scenarios on which contenders are compared; training never uses it."""
SENSORS = ("encoders", "sway", "full")
"""Sets of sensors, each of which sees all that those before it do."""
BASE = "FF + PD"
"""The contender that others are measured against."""

Plant = Literal["crane", "hand"]
Wrap = Callable[..., Any]


@dataclass(frozen=True)
class Contender:
    """A controller in the comparison."""

    name: str
    """Name of its row."""
    wrap: Wrap
    """Function of the environment, and of the policy if learned, that wraps it."""
    plants: tuple[Plant, ...] = ("crane", "hand")
    """What it can drive."""
    sensors: str = "encoders"
    """Sensors that the environment must have."""
    learned: bool = False
    """Whether it needs a policy that was trained with these sensors."""
    emphasis: bool = False
    """Whether its row stands out."""


CONTENDERS: dict[str, Contender] = {}
"""Every contender by its name, in the order of the rows."""


def contender(name: str, **facts: Any) -> Callable[[Wrap], Wrap]:
    """Register the function that wraps an environment; see `Contender` for the keywords."""

    def register(wrap: Wrap) -> Wrap:
        CONTENDERS[name] = Contender(name, wrap, **facts)
        return wrap

    return register


def contenders_for(plant: Plant) -> list[Contender]:
    """The contenders that can drive a crane or a hand."""
    return [entry for entry in CONTENDERS.values() if plant in entry.plants]


@contender("PD, set point")
def set_point(env: Any) -> Any:
    """PD towards the goal from the start."""
    return PD(env, track="set point")


@contender("PD, ZVD shaper", plants=("crane",))
def shaped(env: Any) -> Any:
    """The same, its set point shaped so that the load swings less."""
    return Shaper(set_point(env))


@contender("PD, moving")
def moving(env: Any) -> Any:
    """PD towards the moving reference."""
    return PD(env, track="moving")


contender("feedforward")(Feedforward)


@contender(BASE)
def with_feedback(env: Any) -> Any:
    """The exact inputs, and PD towards the moving reference."""
    return Feedforward(PD(env))


@contender("FF + PID", plants=("crane",))
def with_integral(env: Any) -> Any:
    """The exact inputs, and PID towards the moving reference."""
    return Feedforward(PID(env))


@contender("FF + PD + friction", plants=("crane",))
def with_friction(env: Any) -> Any:
    """The same with PD, and the friction that is expected at the planned speed."""
    return FrictionCompensation(with_feedback(env))


@contender("FF + PD + mass", plants=("crane",))
def with_mass(env: Any) -> Any:
    """Feedforward and PD, and the inputs that the estimated load takes more."""
    return MassEstimate(with_feedback(env))


@contender("FF + PD + pose", plants=("hand",), sensors="full", emphasis=True)
def with_pose(env: Any) -> Any:
    """The same, and feedback of the object's pose."""
    return PoseFeedback(with_feedback(env))


def guarded(env: Any) -> Any:
    """The exact inputs and PD above winches that keep their ropes taut."""
    return with_feedback(TautGuard(env))


@contender("observer", plants=("crane",), emphasis=True)
def with_observer(env: Any) -> Any:
    """An optimal regulator in the place of PD, by what a Kalman filter makes of encoders."""
    return Observer(guarded(env))


def with_swing_damping(env: Any) -> Any:
    """Drives that move against the swing, and the estimated mass."""
    return SwingDamping(MassEstimate(guarded(env)))


def with_regulator(env: Any) -> Any:
    """An optimal regulator in the place of PD, by encoders and load sensors."""
    return LQR(guarded(env))


for sensors in SENSORS[1:]:
    contender(
        f"swing damping, {sensors}",
        plants=("crane",),
        sensors=sensors,
        emphasis=True,
    )(with_swing_damping)
    contender(f"LQR, {sensors}", plants=("crane",), sensors=sensors, emphasis=True)(with_regulator)


def with_residual(env: Any, policy: Policy) -> Any:
    """What a policy has learned, on top of what it was trained on."""
    return LearnedResidual(base_controller(env), policy)


for sensors in SENSORS:
    contender(
        f"residual, {sensors}",
        plants=("crane", "hand") if sensors == "encoders" else ("crane",),
        sensors=sensors,
        learned=True,
        emphasis=True,
    )(with_residual)
