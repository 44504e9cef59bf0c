"""Captions of the figures of Y chapters 4 to 6: machine, path, what is compared, what differs.

Machine and path are told from the data that is drawn.
"""

import inspect
from collections.abc import Sequence

from ...models.rig.catalogue import CATALOGUE
from .figures_y_data import Case, Lines, Snapshots

FREE_TO_PUSH = (
    "The tagline has to push, down to -442 N at 2 s: pulling ropes need 4.06 s. The start is a "
    "singular place, taken here as the limit of the motion."
)
HEAVY_PUSH = (
    "The tagline has to push, down to -9177 N, and with 231 N even at rest at the goal. "
    "Coordinates do not depend on the step, inputs do."
)
CABLEV = (
    "The platform's side is not printed and follows from the initial configuration (1.2 m); the "
    "winches' inertias are not printed either and are set to the printed J1, J2, J3, which are "
    "the platform's. z points up here: alpha and beta have the other sign."
)
NOTES = {
    ("Y4.2", "Y4.3", "Y4.4"): (
        "Y 4.4.1 has z downwards, here it points up. The constraint Y 4.57 is not halved, so the "
        "printed multiplier is half the rope's tension over its length, which is shown."
    ),
    ("Y4.7", "Y4.8", "Y4.9"): (
        "Y 4.4.2 says that it uses table 4.1; the other rotary cranes have the data of Y 5.3.2."
    ),
    ("Y4.8", "Y4.9"): (
        "In print ALT stays off the others by about 0.1, however small the step, and Y does not "
        "know why. Here it converges as the others do: on the bridge and the trolley it is GEN, on "
        "the winch near it, and the coordinates are exact within 1e-10. The Coriolis signs of Y "
        "4.106 and 5.75, which are wrong, do not explain the 0.1: with them the inputs would be "
        "off by 25 N m and 18 N. One slip would: 9.80 for 9.81 m/s2 in ALT alone makes 0.100 N in "
        "the rope's force, constant and whatever the step, and moves no coordinate by more than "
        "about 0.1 mm. The text cannot prove it."
    ),
    ("Y5.3", "Y5.4"): "Coordinates do not depend on the step, inputs do.",
    ("Y5.7", "Y5.8"): (
        "Coordinates do not depend on the step, inputs do. At 1 s the torque on the bridge is off "
        "by more than its largest value."
    ),
    ("Y5.12", "Y5.13", "Y5.14", "Y5.15"): (
        "In the printed layout winch 1 has to push with the load's weight all along; the "
        "catalogue's crane has it at the other end of the girder. The source's winches have no "
        "inertia, here they need some."
    ),
    ("Y5.12", "Y5.13"): "The reduced l is the rope below the trolley, L2 - L0 (Y 5.135).",
    ("Y6.2", "Y6.3", "Y6.4", "Y6.5"): FREE_TO_PUSH,
    ("Y6.7", "Y6.8", "Y6.9", "Y6.10"): HEAVY_PUSH,
    ("Y6.13",): "The start is a singular place, taken here as the limit of the motion.",
    ("Y6.13", "Y6.16"): (
        "The tip of the boom, x3 and y3, follows from its angle here, and the multiplier of its "
        "circle (Y 6.28, 6.40) appears as that of a unit vector along the boom, r^2 = 75 m2 times "
        "as large."
    ),
    ("Y6.16", "Y6.17"): (
        "The index is 7 and the path would need six derivatives; the printed one has four. "
        "The boom's torque jumps where its pieces join, and the jump grows as the step "
        "shrinks. The suspension rope has to push, down to -405 N."
    ),
    tuple(f"Y6.{k}" for k in range(21, 31)): CABLEV,
}
"""What differs from print and why, for figures by name."""


def caption(name: str, content: Lines | Snapshots) -> str:
    """Machine, path, what is compared, and notes, in a paragraph."""
    if isinstance(content, Snapshots):
        compared = "Poses of the exact motion with their times, and the ways of what hangs, dotted."
    else:
        compared = _compared(content)
    notes = [note for names, note in NOTES.items() if name in names]
    return " ".join([machine(content.case), path(content.case), compared, *notes])


def machine(case: Case) -> str:
    """The crane with all its numbers."""
    parameters = inspect.signature(CATALOGUE[case.name]).parameters
    values = {key: parameter.default for key, parameter in parameters.items()}
    values |= dict(case.overrides)
    numbers = ", ".join(f"{key} {value:.6g}" for key, value in values.items())
    return f"`{case.name}`: {numbers}."


def path(case: Case) -> str:
    """The move."""
    move = case.path
    ends = f"from {_place(move.start)} to {_place(move.goal)} in {move.duration:g} s"
    profile = (
        "three phases as in Y4.6"
        if move.profile == "three_phase"
        else f"degree {2 * move.order + 1}"
    )
    return f"Path: {', '.join(case.rig.outputs)} {ends}, {profile}."


def _place(values: Sequence[float]) -> str:
    return f"({', '.join(f'{value:.4g}' for value in values)})"


def _compared(content: Lines) -> str:
    """Formulations and steps against the exact solution."""
    formulations = dict.fromkeys(run.formulation for run in content.runs)
    steps = " and ".join(dict.fromkeys(f"{run.step:g}" for run in content.runs))
    if len(formulations) == 1:
        what = f"{next(iter(formulations)).capitalize()} at steps of {steps} s"
    else:
        known = "; ".join(f"{run.label} = {run.formulation}" for run in content.runs)
        what = f"{known}; at steps of {steps} s"
    return f"{what}, and the exact solution."
