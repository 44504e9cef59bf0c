"""What might be wrong with a rig whose equations do not determine everything."""

from ...models.rig.open_tensions import TENSION, redundant_bodies
from ...models.rig.rig import WORLD, Rig


def what_to_change(rig: Rig) -> str:
    """What to look at in a rig that is structurally singular, as the end of a message."""
    bodies = redundant_bodies(rig)
    for body in bodies:
        for rope in body.ropes:
            if rope.coordinate in rig.outputs:
                return (
                    f"{rope.coordinate} follows from where {body.body.name} is; prescribe "
                    f'"{rope.name}{TENSION}" in its place, or leave it out'
                )
    hint = f' (tensions such as "{bodies[0].ropes[0].name}{TENSION}", too)' if bodies else ""
    return f"check its outputs{hint} and drives{_idle(rig)}"


def _idle(rig: Rig) -> str:
    """A frame that nothing stands on, as the end of a message; nothing if there is none."""
    used = {anchor.frame for anchor in rig.anchors} | {rail.frame for rail in rig.rails}
    used |= {frame.parent for frame in rig.frames}
    idle = next((frame.name for frame in rig.frames if frame.name not in used), None)
    if idle is None:
        return ""
    other = next((f.name for f in rig.frames if f.parent == WORLD and f.name in used), None)
    such = f', such as parent = "{idle}" in frame {other}' if other else ""
    return f"; frame {idle} carries nothing, what stands on it names it as frame or parent{such}"
