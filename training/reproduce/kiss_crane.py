"""The small model of the US Navy crane that Kiss studied (scale 1:80), in a plane and in space.

Printed in K 3.3, 3.4.2 and 3.5: the masses of the load, J = 6.25e-3 for the winches, l = 0.35 m
between winches A and P, the boom's angle of 0.445 rad, the planar gains, all moves.  Not printed,
and chosen here:

- k, from the boom's foot to A: 0.2 m, with which every printed place lies under the boom;
- s, from P to S, 0.2 m, the pulley's mass, 20 g, and the boom's, 1 kg at the radius of P;
- the drums' radius, 10 mm.  K's J/rho with rope forces as inputs is a mass along the rope; the
  printed number is taken for that mass, J/rho^2 = 6.25e-3 kg, since a drum of any size that fits
  would make of J = 6.25e-3 kg m2 tens of kilograms;
- the gains in space: the source says that its results do not depend on them much (theorem 6).
"""

import math
from dataclasses import replace

from ...feedforward import Reference, Regulator, rest_to_rest
from ...models import Rig, navy_crane_2d, navy_crane_3d

ALONG, RADIUS, ANGLE, FOOT, BOOM = 6.25e-3, 0.01, 0.445, 0.2, 0.35
"""Mass of a winch along its rope [kg], drum radius [m], boom angle [rad], k and l [m]."""
SUSPENSION, PULLEY, PLATFORM = 0.2, 0.02, 1.0
"""s [m], mass of the pulley and of the boom [kg]."""

PLANAR_TARGET = (-0.1, -0.5)
"""Load's place to be held, from P [m] (K 3.4.2)."""
START, GOAL = (0.142, 0.015, -0.05), (0.004, 0.16, -0.05)
"""Ends of the tracking study, from the boom's foot [m] (K 3.5)."""
TRAVEL = 2.5
"""Duration of the tracking study's move [s]."""
HEIGHT = 0.2
"""Height of the pulley above the boom's foot [m]."""

START_ERROR = (0.02, -0.01)
"""How far the load really hangs from there, in x and y [m]; K only says that it does."""

NOT_PRINTED = (
    "Not printed and chosen: pulley 20 g, boom 1 kg at the radius of P, k = s = 0.2 m, drums of "
    "10 mm"
)
SPATIAL = "The small Navy crane in space (K 3.3, 3.5: load 250 g, l = 0.35 m, boom at 0.445 rad),"
"""For captions."""

STIFFNESS, DAMPING = (3.0, 40.0, 17.0, 1.4), (3.0, 8.0, 22.0, 0.15)
"""Gains in space for tagline, suspension, hoist [N/m, N s/m] and boom [N m/rad, N m s/rad]: from a
search for those with which the set point of the tracking study is reached soonest, ropes taut."""


def planar() -> Rig:
    """The crane in a plane with a massless pulley (K 3.1.1, 3.4.2), origin P, at home at rest."""
    rig = navy_crane_2d(
        load_mass=0.2,
        pulley_mass=0.0,
        winch_inertia=ALONG * RADIUS**2,
        drum_radius=RADIUS,
        boom_angle=ANGLE,
        tagline_distance=BOOM,
    )
    x, z = PLANAR_TARGET
    beta, gamma = planar_angles(x)
    upper = BOOM * math.sin(gamma - beta) / math.sin(gamma)
    pulley = (-upper * math.sin(ANGLE - beta), 0.0, -upper * math.cos(ANGLE - beta))
    return replace(rig, home={"pulley": pulley, "load": (x, 0.0, z)})


def planar_angles(x: float) -> tuple[float, float]:
    """Angles beta and gamma [rad] with the load at rest at x from P [m] (K 3.60).

    beta is between hoist rope and boom, gamma between tagline and lower hoist rope.
    """
    beta = math.asin(math.sin(ANGLE) + x / BOOM)
    return beta, 0.5 * (math.pi + beta - ANGLE)


def planar_regulator() -> Regulator:
    """Gains of K 3.4.2: k_pL1 = 10, k_pR = 20, k_dL1 = 20, k_dR = 10."""
    return Regulator(planar(), PLANAR_TARGET, stiffness=(10.0, 20.0), damping=(20.0, 10.0))


def spatial() -> Rig:
    """The crane in space with a pulley of 20 g (K example 11, 3.5), at home at `START`."""
    rig = navy_crane_3d(
        load_mass=0.25,
        pulley_mass=PULLEY,
        platform_mass=PLATFORM,
        winch_inertia=ALONG * RADIUS**2,
        drum_radius=RADIUS,
        boom_angle=ANGLE,
        tagline_distance=FOOT,
        hoist_distance=FOOT + BOOM,
        suspension_distance=FOOT + BOOM + SUSPENSION,
    )
    x, y, z = START
    return replace(
        rig, home={"boom": math.atan2(y, x), "pulley": (x, y, HEIGHT), "load": (x, y, z)}
    )


def spatial_regulator(goal: tuple[float, ...] = GOAL) -> Regulator:
    """PD of K 3.82 at a goal of the load."""
    return Regulator(spatial(), (*goal, HEIGHT), stiffness=STIFFNESS, damping=DAMPING)


def move(duration: float = TRAVEL, goal: tuple[float, ...] = GOAL) -> Reference:
    """Straight line of the load from `START`, degree 13 (K 3.57)."""
    return rest_to_rest((*START, HEIGHT), (*goal, HEIGHT), duration, order=6)
