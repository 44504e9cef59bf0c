"""Write hands as XML for plain MuJoCo: `flatrig scenes`.

    two_finger_hand.xml         # the machine: what a simulation needs, and sensors
    two_finger_hand_scene.xml   # the same with all that is to be seen: for viewers

Numbers are written with all their digits: both files move as `compile_hand` does, bit for bit.  The
chequers that show how an object rolls are on the geoms of its body, so that the scene is a file of
its own and includes no other.
"""

import mujoco

from ..hand.hand import Hand
from .hand_model import OBJECT, hand_spec
from .rig_model import memory

COMMENT = "Made from the hand's description by `flatrig scenes`."


def hand_xml(hand: Hand) -> str:
    """A hand's machine as MJCF text."""
    scene = hand_spec(hand, visuals=False)
    scene.memory = memory(scene)
    return _text(scene, hand)


def hand_scene_xml(hand: Hand) -> str:
    """A hand's scene as MJCF text."""
    return _text(hand_spec(hand), hand)


def _text(scene: mujoco.MjSpec, hand: Hand) -> str:
    _add_sensors(scene, hand)
    scene.comment = COMMENT
    scene.compile()
    return str(scene.to_xml())


def _add_sensors(scene: mujoco.MjSpec, hand: Hand) -> None:
    """Encoders of slides, and where the object is and how it is turned."""
    joint, body = mujoco.mjtObj.mjOBJ_JOINT, mujoco.mjtObj.mjOBJ_XBODY
    for finger in hand.fingers:
        for k in range(1, len(finger.slides) + 1):
            name = f"{finger.name}.slide{k}"
            for suffix, kind in (
                ("", mujoco.mjtSensor.mjSENS_JOINTPOS),
                (".rate", mujoco.mjtSensor.mjSENS_JOINTVEL),
            ):
                scene.add_sensor(name=name + suffix, type=kind, objtype=joint, objname=name)
    for name, kind in (
        ("position", mujoco.mjtSensor.mjSENS_FRAMEPOS),
        ("quaternion", mujoco.mjtSensor.mjSENS_FRAMEQUAT),
    ):
        scene.add_sensor(name=f"{OBJECT}.{name}", type=kind, objtype=body, objname=OBJECT)
