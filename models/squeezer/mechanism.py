"""Andrews' squeezing mechanism: its numbers, its published solution, its MuJoCo scene (Y 3.5).

Seven planar bodies around a motor, a spring and three closed loops; no gravity, from rest, one
degree of freedom, and in 0.03 s a crank that turns two and a half times.  The numbers are those of
the IVP test set (problem "andrews"), not the rounded tables Y 3.1 and 3.2: the rounding alone moves
the final angle by 0.02 rad.

In the scene the three loops close at point P, where four bodies meet, with `connect` constraints,
which MuJoCo keeps as stiff springs with dampers::

    model = mujoco.MjModel.from_xml_string(squeezer.scene(timestep=1e-5))
"""

from dataclasses import dataclass
from math import cos, sin

MASSES = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)
"""Masses of K1 to K7 [kg]."""
INERTIAS = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)
"""Moments of inertia of K1 to K7 about their centres of mass [kg m2]."""
ANGLES = ("beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon")
"""The test set's coordinates: absolute for K1, K3, K5, K7, against K1, K5, K7 for K2, K4, K6."""
START = (
    -0.0617138900142764496,
    0.0,
    0.455279819163070380,
    0.222668390165885885,
    0.487364979543842551,
    -0.222668390165885885,
    1.23054744454982119,
)
"""The angles at rest at t = 0 [rad]."""
DURATION = 0.03
"""Duration of the published run [s]."""
PUBLISHED = (
    15.81077119629904,
    -15.75637105984298,
    0.04082224013073101,
    -0.5347301163226948,
    0.5244099658805304,
    0.5347301163226948,
    1.048080741042263,
)
"""The angles at t = 0.03 s [rad], good to about nine digits."""
PUBLISHED_ACCURACY = 3e-9
"""How well the published beta is known [rad]."""
TORQUE = 0.033
"""Torque of the motor on K1 [N m]."""
STIFFNESS, REST_LENGTH = 4530.0, 0.07785
"""Stiffness and rest length of the spring between C and D [N/m, m]."""
PIVOT_A, PIVOT_B, ANCHOR_C = (-0.06934, -0.00227), (-0.03635, 0.03273), (0.014, 0.072)
"""Fixed points [m]; the motor stands at the origin."""


@dataclass(frozen=True)
class Link:
    """One body: where its points lie in its own axes, which start at `joint` [m]."""

    parent: int | None
    """The body that it turns against; None is the ground."""
    joint: tuple[float, float]
    """Where it turns, in the parent's axes [m]."""
    centre: tuple[float, float]
    """Its centre of mass [m]."""
    ends: dict[str, tuple[float, float]]
    """Its other joints by name [m]."""


LINKS = (
    Link(None, (0.0, 0.0), (0.00092, 0.0), {"G": (0.007, 0.0)}),
    Link(0, (0.007, 0.0), (-0.0115, 0.0), {"P": (-0.028, 0.0)}),
    Link(None, PIVOT_B, (0.01043, -0.01874), {"P": (0.0, -0.035), "D": (0.02, -0.018)}),
    Link(4, (0.04, 0.0), (0.0, -(0.02 - 0.01421)), {"P": (0.0, -0.02)}),
    Link(None, PIVOT_A, (0.02308, 0.00916), {"E": (0.04, 0.0)}),
    Link(6, (0.0, -0.04), (0.02 - 0.01421, 0.0), {"P": (0.02, 0.0)}),
    Link(None, PIVOT_A, (-0.00449, -0.01228), {"F": (0.0, -0.04)}),
)
"""K1 to K7, each turned by its angle of `ANGLES` against its parent."""


def angle_of(body: int, angles: tuple[float, ...]) -> float:
    """Absolute angle of body K(body + 1) [rad]."""
    parent = LINKS[body].parent
    return angles[body] + (0.0 if parent is None else angles[parent])


def origin_of(body: int, angles: tuple[float, ...]) -> tuple[float, float]:
    """World position of a body's own origin [m]."""
    parent, joint = LINKS[body].parent, LINKS[body].joint
    return joint if parent is None else world(parent, joint, angles)


def world(body: int, point: tuple[float, float], angles: tuple[float, ...]) -> tuple[float, float]:
    """World position of a point of a body [m]."""
    angle, (x, y) = angle_of(body, angles), origin_of(body, angles)
    c, s = cos(angle), sin(angle)
    return x + c * point[0] - s * point[1], y + s * point[0] + c * point[1]


def scene(timestep: float, integrator: str = "RK4") -> str:
    """The MJCF scene, whose joint angles are `ANGLES` and start at `START`.

    Parameters
    ----------
    timestep
        Time step [s].  The closures' time constant is two of them, the stiffest that MuJoCo keeps
        stable; with its defaults, beta ends several radians off.
    integrator
        One of MuJoCo's.
    """
    bodies = "\n".join(_body(i, indent=4) for i, link in enumerate(LINKS) if link.parent is None)
    closures = "\n".join(
        f'    <connect name="{name}" site1="K{first}.P" site2="K{second}.P"/>'
        for name, first, second in (("P23", 2, 3), ("P24", 2, 4), ("P26", 2, 6))
    )
    closing = f'solref="{2 * timestep:.17g} 1" solimp="0.9999 0.9999 0.001"'
    start = " ".join(repr(angle) for angle in _joint_order(START))
    return f"""<mujoco model="squeezer">
  <compiler angle="radian" autolimits="true"/>
  <option timestep="{timestep:.17g}" integrator="{integrator}" gravity="0 0 0"
          tolerance="0" iterations="50">
    <flag contact="disable"/>
  </option>
  <default>
    <equality {closing}/>
  </default>
  <worldbody>
    <site name="C" pos="{_pos(ANCHOR_C)}"/>
{bodies}
  </worldbody>
  <equality>
{closures}
  </equality>
  <tendon>
    <spatial name="spring" stiffness="{STIFFNESS!r}" springlength="{REST_LENGTH!r}">
      <site site="C"/>
      <site site="K3.D"/>
    </spatial>
  </tendon>
  <actuator>
    <motor name="motor" joint="beta"/>
  </actuator>
  <keyframe>
    <key name="start" qpos="{start}" ctrl="{TORQUE!r}"/>
  </keyframe>
</mujoco>
"""


def _joint_order(angles: tuple[float, ...]) -> list[float]:
    """Values of the bodies in the order in which MuJoCo numbers their joints."""
    return [angles[i] for i in _depth_first()]


def joint_names() -> tuple[str, ...]:
    """Names of the scene's joints in MuJoCo's order."""
    return tuple(ANGLES[i] for i in _depth_first())


def _depth_first(parent: int | None = None) -> list[int]:
    order = []
    for i, link in enumerate(LINKS):
        if link.parent == parent:
            order += [i, *_depth_first(i)]
    return order


def _body(i: int, indent: int) -> str:
    link, pad = LINKS[i], " " * indent
    inertia = INERTIAS[i]
    # Only the moment about z acts in the plane; half of it twice is a body that can exist.
    diagonal = f"{0.5 * inertia!r} {0.5 * inertia!r} {inertia!r}"
    lines = [
        f'{pad}<body name="K{i + 1}" pos="{_pos(link.joint)}">',
        f'{pad}  <joint name="{ANGLES[i]}" type="hinge" axis="0 0 1"/>',
        f'{pad}  <inertial pos="{_pos(link.centre)}" mass="{MASSES[i]!r}" '
        f'diaginertia="{diagonal}"/>',
    ]
    for name, place in link.ends.items():
        lines.append(f'{pad}  <site name="K{i + 1}.{name}" pos="{_pos(place)}"/>')
    for k, other in enumerate(LINKS):
        if other.parent == i:
            lines.append(_body(k, indent + 2))
    return "\n".join([*lines, f"{pad}</body>"])


def _pos(point: tuple[float, float]) -> str:
    return f"{point[0]!r} {point[1]!r} 0"
