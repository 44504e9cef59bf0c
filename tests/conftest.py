"""Rigs that are not in the catalogue and random states, for what must work for any description."""

import os
from dataclasses import replace

import numpy as np
import pytest

from flatrig.models import Anchor, Drive, Frame, Load, Rail, Rig, Rope, Trolley
from flatrig.models.mjcf.ropes import home_length
from flatrig.models.rig.chain import apart, chain_of

# Tables are as wide as in a file, whatever the terminal, or the processes that tests share, say.
os.environ.pop("COLUMNS", None)

ROOT3 = np.sqrt(3.0)


def rope(name, *path):
    return Rope(name, path, drum_radius=0.1, winch_inertia=0.1)


def carried(kind):
    """A rail with winches at both ends, turning (cantilever) or sliding along y (gantry)."""
    axis = (0.0, 0.0, 1.0) if kind == "turning" else (0.0, 1.0, 0.0)
    return Rig(
        name=kind,
        frames=(Frame("boom", kind, 480.0, axis),),
        anchors=(Anchor("outer", (8.0, 0, 0), "boom"), Anchor("inner", (-2.0, 0, 0), "boom")),
        rails=(Rail("rail", (1.0, 0.0, 0.0), frame="boom"),),
        masses=(Trolley("trolley", 10.0, "rail"), Load("load", 100.0)),
        ropes=(rope("pull", "outer", "trolley"), rope("hoist", "inner", "trolley", "load")),
        drives=(Drive("pull", "pull", 1), Drive("hoist", "hoist", 1), Drive("boom", "boom", 1)),
        outputs=("load.x", "load.y", "load.z"),
        home={"trolley": 5.0, "load": (5.0, 0.0, -5.0)},
    )


def planar_navy_crane():
    """Y 6.1.2: origin at winch S, alpha = pi/3, s = 5, l = 10."""
    along = np.array([-ROOT3 / 2, 0.0, -0.5])
    return Rig(
        name="planar_navy_crane",
        dimensions=2,
        anchors=(
            Anchor("A", tuple(15 * along)),
            Anchor("P", tuple(5 * along)),
            Anchor("S", (0.0, 0.0, 0.0)),
        ),
        masses=(Load("pulley", 150.0), Load("load", 100.0)),
        ropes=(
            rope("one", "A", "pulley"),
            rope("two", "P", "pulley", "load"),
            rope("three", "S", "pulley"),
        ),
        drives=tuple(Drive(name, name, 1.0) for name in ("one", "two", "three")),
        outputs=("load.x", "load.z", "pulley.z"),
        home={"pulley": (-2.5 * ROOT3, 0, -12.5), "load": (-2.5 * ROOT3, 0, -22.5)},
    )


def navy_crane():
    """Y 6.2.2: boom tip P = (5 sqrt3, 0, 5), A = P/2, S = 3P/2."""
    tip = np.array([5 * ROOT3, 0.0, 5.0])
    return Rig(
        name="navy_crane",
        frames=(Frame("boom", "turning", 6.4 * 75.0),),
        anchors=tuple(
            Anchor(name, tuple(share * tip), "boom")
            for name, share in zip("APS", (0.5, 1, 1.5), strict=True)
        ),
        masses=(Load("pulley", 5.0), Load("load", 100.0)),
        ropes=(
            rope("one", "A", "pulley"),
            rope("two", "S", "pulley"),
            rope("three", "P", "pulley", "load"),
        ),
        drives=(
            *(Drive(name, name, 1.0) for name in ("one", "two", "three")),
            Drive("b", "boom", 1),
        ),
        outputs=("load.x", "load.y", "load.z", "pulley.z"),
        home={"pulley": (5 * ROOT3, 0.0, 2.5), "load": (5 * ROOT3, 0.0, -15.0)},
    )


def tower_crane():
    """A turning jib with a roped trolley, whose hoist ends in a block on four falls."""
    hoist = replace(rope("hoist", "inner", "trolley", "load"), falls=4)
    plain = carried("turning")
    return replace(plain, name="tower_crane", ropes=(plain.ropes[0], hoist))


@pytest.fixture(scope="session")
def other_rigs() -> dict[str, Rig]:
    """Cantilever, gantry, both Navy cranes and a four-fall tower crane by name."""
    return {
        "cantilever": carried("turning"),
        "gantry": carried("sliding"),
        "planar navy": planar_navy_crane(),
        "navy": navy_crane(),
        "four falls": tower_crane(),
    }


@pytest.fixture(scope="session")
def random_states():
    """A function of a rig: joint positions about home, velocities, inputs within the limits."""

    def draw(rig, count=20):
        generator = np.random.default_rng(7)
        home = np.array([value for link in chain_of(rig) for value in link.home])
        if apart(rig):  # its ropes have spools
            home = np.append(home, [home_length(rig, rope) for rope in rig.ropes])
        limits = np.array([drive.limit for drive in rig.drives])
        return (
            home + generator.uniform(-0.8, 0.8, (count, len(home))),
            generator.uniform(-1, 1, (count, len(home))),
            limits * generator.uniform(-1, 1, (count, len(limits))),
        )

    return draw
