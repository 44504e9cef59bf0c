"""Rolling-contact hands: classification, planning and grasp forces (K chapter 2).

    hand = models.make_hand("three_finger_hand")
    move = models.default_hand_move(hand)
    motion = plan_hand(hand, move)(np.linspace(0, move.duration, 1001))
    forces = in_cones(motion)                       # contact forces inside the friction cones
    inputs = joint_forces(motion, forces)           # of the fingers' motors
    print(classify(hand))                           # holonomic, flat, Liouvillian, and why

Contacts are points and roll without slipping; the object is a sphere, or a disc in a plane.
"""

from .classification import Classification, classify, table
from .cones import in_cones
from .grasp import ContactForces, Outside, grasp_matrix, least_norm, wrench
from .hand_motion import HandMotion
from .hand_plan import HandPlan, plan_hand
from .joints import JointForces, joint_forces
from .kinematics import Rolling, constraint_matrix
from .limits import check_limits
from .overview import report
from .reintegration import Replay, Residuals, replay, residuals

__all__ = [
    "Classification",
    "ContactForces",
    "HandMotion",
    "HandPlan",
    "JointForces",
    "Outside",
    "Replay",
    "Residuals",
    "Rolling",
    "check_limits",
    "classify",
    "constraint_matrix",
    "grasp_matrix",
    "in_cones",
    "joint_forces",
    "least_norm",
    "plan_hand",
    "replay",
    "report",
    "residuals",
    "table",
    "wrench",
]
