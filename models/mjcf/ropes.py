"""What ropes are made of in a MuJoCo model: rigid, elastic, able to go slack, or constraints.

    model = models.compile(rig, ropes="slack")
    model = models.compile(rig, ropes=models.Ropes("elastic", stiffness=1e6, damping_ratio=0.05))

- `rigid`, the default: the rope's length is that of its winch, without a constraint; it pushes
  where a real rope would go slack.
- `elastic`: the winch is a spool, a body of inertia J/r^2 that pays out rope, and between what it
  has paid out, w, and the way L that the rope has to go stands a spring: T = k (L - w) + c d/dt
  (L - w).  As k grows the rope becomes the rigid one; it pushes as that does.
- `slack`: the spool again, but the rope only pulls.  Without a stiffness a limit L <= w holds it,
  as stiff as the time step can bear; with one, a spring that a shorter way leaves unstretched.

- `equality`: the spool again, and a constraint L = w that holds both ways.  It is what `rigid`
  becomes where ropes tie together what no chain of bodies holds, `flatrig.models.rig.chain.apart`:
  two frames, trolleys on rails that are not parallel, two platforms.  MuJoCo's equality leaves out
  what turns a moving rope and makes it good by a stretch of some 1e-9 m.

These are properties of the model, not of the description: exact feedforward is that of
inextensible ropes, and a move under other ropes shows what this neglects.

Limits: EA gives k = EA/L at home, and k stays.  A one-sided spring has no damping, since MuJoCo's
would hold a slack rope back too.  Stretch lies between winch and first point: sheaves with inertia
turn with the way beyond them.  Friction of a winch is that of its spool's joint.  A spool holds
`REACH` times the rope's length at home.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ModelError, did_you_mean
from ..rig.chain import apart
from ..rig.rig import Rig, Rope
from ..types import Array
from ..values import bounded, reals

KINDS = ("rigid", "elastic", "slack", "equality")
"""What ropes may be."""

EA = 1e7
"""Young's modulus times cross section of an elastic rope if no stiffness is given [N]: that of a
steel wire rope 16 mm thick."""

DAMPING_RATIO = 0.02
"""Damping over the critical one of an elastic rope if none is given."""

REACH = 100.0
"""Rope on a spool over its length at home, which counts as one metre at least."""

PerRope = float | Mapping[str, float]
"""One number for all ropes, or one for each by its name."""


@dataclass(frozen=True)
class Ropes:
    """The ropes of a model.

    Raises
    ------
    ModelError
        An option is wrong or does not go with another.
    """

    kind: str = "rigid"
    """One of `KINDS`."""
    stiffness: PerRope | None = None
    """Stiffness k of the ropes [N/m]; not together with `ea`."""
    ea: PerRope | None = None
    """Young's modulus times cross section [N], from which k = EA/L with the length L at home."""
    damping: PerRope | None = None
    """Damping c of elastic ropes [N s/m]; not together with `damping_ratio`."""
    damping_ratio: PerRope | None = None
    """Damping over the critical one of each rope by itself, at home."""

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ModelError(f"ropes cannot be {self.kind!r}{did_you_mean(str(self.kind), KINDS)}")
        given = [item.name for item in fields(self)[1:] if getattr(self, item.name) is not None]
        for one, other in (("stiffness", "ea"), ("damping", "damping_ratio")):
            if one in given and other in given:
                raise ModelError(f"ropes: give {one} or {other}, not both")
        fitting = {"rigid": (), "slack": ("stiffness", "ea"), "equality": ()}.get(
            self.kind, tuple(given)
        )
        for name in given:
            if name not in fitting:
                raise ModelError(f"ropes: {self.kind} ropes have no {name}; elastic ones have")
            for value in _values(getattr(self, name)):
                _check(name, value, 0.0 if name.startswith("damping") else None)

    @property
    def spooled(self) -> bool:
        """Whether winches are spools, bodies of their own."""
        return self.kind != "rigid"

    def spring(self, rig: Rig, rope: Rope) -> float:
        """Stiffness k of a rope [N/m]; 0 where a limit holds it.

        Raises
        ------
        ModelError
            Ropes are given by name, but not this one.
        """
        if self.stiffness is not None:
            return _of(self.stiffness, "stiffness", rope)
        if self.ea is None and self.kind in ("slack", "equality"):
            return 0.0
        return _of(EA if self.ea is None else self.ea, "ea", rope) / home_length(rig, rope)

    def damper(self, rope: Rope, critical: float) -> float:
        """Damping c of an elastic rope [N s/m], given the critical one; 0 of others."""
        if self.kind != "elastic":
            return 0.0
        if self.damping is not None:
            return _of(self.damping, "damping", rope)
        ratio = DAMPING_RATIO if self.damping_ratio is None else self.damping_ratio
        return critical * _of(ratio, "damping_ratio", rope)


def ropes_of(ropes: str | Ropes, rig: Rig) -> Ropes:
    """The ropes that are meant, by a word or in full.

    Raises
    ------
    ModelError
        There are none of that kind, or names are not those of the rig's ropes.
    """
    ropes = ropes if isinstance(ropes, Ropes) else Ropes(ropes)
    if ropes.kind == "rigid" and apart(rig):
        ropes = Ropes("equality")
    for option in (ropes.stiffness, ropes.ea, ropes.damping, ropes.damping_ratio):
        for name in option if isinstance(option, Mapping) else ():
            if name not in rig.rope_names:
                known = did_you_mean(name, rig.rope_names)
                raise ModelError(f"rig {rig.name} has no rope {name!r}{known}")
    return ropes


def spool(rope: Rope) -> str:
    """Name of the spool's body and joint; the joint is the length w that is paid out [m]."""
    return f"{rope.name}.spool"


def stretch_of(rope: Rope) -> str:
    """Name of the tendon that holds the rope: its length is L - w and a constant."""
    return f"{rope.name}.stretch"


def home_length(rig: Rig, rope: Rope) -> float:
    """Length of a rope's way at home [m]."""
    path = np.array([rig.home_point(name) for name in rope.path])
    spans = np.linalg.norm(np.diff(path, axis=0), axis=1)
    return float(spans[:-1].sum() + rope.falls * spans[-1])


def reach(rig: Rig, rope: Rope) -> float:
    """Most rope that a spool pays out [m]."""
    return REACH * max(1.0, float(f"{home_length(rig, rope):.2g}"))


def stiffness(model: Any, rope: Rope) -> float:
    """What a rope's tension rises by for each metre of stretch, at rest [N/m]; rigid: infinite.

    That of a limit follows from MuJoCo's regularisation (its `solref`, `solimp`): the force of a
    constraint at rest is K I r / R, with R = A (1 - I) / I and K = 1 / (I t)^2.
    """
    if not _has_spool(model, rope):
        return float("inf")
    index = model.tendon(stretch_of(rope)).id
    if spring := float(np.atleast_1d(model.tendon_stiffness[index])[0]):
        return spring
    if model.tendon_limited[index]:
        share, time = model.tendon_solimp_lim[index, 0], model.tendon_solref_lim[index, 0]
    else:
        equal = model.equality(stretch_of(rope)).id
        share, time = model.eq_solimp[equal, 0], model.eq_solref[equal, 0]
    return float(1.0 / ((1.0 - share) * time**2 * float(model.tendon_invweight0[index])))


def stretches(rig: Rig, model: Any, tensions: ArrayLike) -> Array:
    """Stretch L - w of each rope at rest under tensions [N], (N, ropes) [m].

    Tensions are (N, ropes), or (N, ropes + links) as a motion has them.
    """
    pull = reals("tensions", tensions)
    pull = pull[..., : len(rig.ropes)] if pull.ndim else pull
    stiff = np.array([stiffness(model, rope) for rope in rig.ropes])
    return np.asarray(pull / stiff)


def _has_spool(model: Any, rope: Rope) -> bool:
    return any(model.joint(i).name == spool(rope) for i in range(model.njnt))


def _values(option: PerRope) -> list[float]:
    return list(option.values()) if isinstance(option, Mapping) else [option]


def _of(option: PerRope, name: str, rope: Rope) -> float:
    if not isinstance(option, Mapping):
        return float(option)
    if rope.name not in option:
        raise ModelError(f"ropes: {name} is given by rope, but not for {rope.name}")
    return float(option[rope.name])


def _check(name: str, value: Any, lowest: float | None) -> None:
    """Refuse what is not a finite number > 0, or >= `lowest` if there is one."""
    label = f"ropes: {name}"
    if lowest is None:
        bounded(label, value, above=0.0, rule="a number > 0", error=ModelError)
    else:
        rule = f"a number >= {lowest:g}"
        bounded(label, value, least=lowest, rule=rule, error=ModelError)
