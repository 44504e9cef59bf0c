"""What a crane carries, which wind pushes and whose mass nobody knows exactly."""

from ...models.rig.rig import Load, Platform, Rig


def payloads(rig: Rig) -> list[Load | Platform]:
    """Loads that no rope runs over, and platforms; free pulleys belong to the crane."""
    return [*(load for load in rig.loads if load.name not in rig.pulleys), *rig.platforms]
