"""What a policy sees of a crane: the entries of `flatrig.envs.sensing`, with its own units.

The unit is l, and the typical time tau, of `Scales`; 1 rad for turning frames.  With sensors="full"
or "sway" follow, for every output, rope and link, as `flatrig.envs.crane.load_sensors` has them:

    NAME.error, NAME.rate_error         of the output        over 0.05 l and 0.05 l / tau
    NAME.tension                                             over the loads' weight

An angle that is an output counts times its lever, as in `flatrig.envs.crane.outputs.levers`.
"""

import numpy as np

from ...models.rig.rig import Frame, Rig
from ..sensing import FINE, Observation, Sensor
from ..signals import Encoders, Rows
from .geometry import Scales
from .load_sensors import LoadSensors
from .outputs import levers
from .plant import Plant


def observation_of(
    plant: Plant, encoders: Encoders, rows: Rows, loads: LoadSensors | None
) -> Observation:
    """The observations of n simulations, with loads and tensions where they are measured."""
    rig, scales = plant.rig, plant.geometry.scales
    units = np.array([
        1.0 if isinstance(part, Frame) and part.kind == "turning" else scales.length
        for part in map(rig.driven, rig.drives)
    ])  # fmt: skip
    sensors = [] if loads is None else _beyond_encoders(rig, scales, loads)
    names, home = [drive.name for drive in rig.drives], plant.drives_at(plant.home)
    return Observation(encoders, rows, names, units, scales.time, home, sensors)


def _beyond_encoders(rig: Rig, scales: Scales, loads: LoadSensors) -> list[Sensor]:
    errors = FINE * scales.length / levers(rig, scales)
    return [
        Sensor(
            [f"{output}.error" for output in rig.outputs],
            errors,
            lambda out: np.copyto(out, loads.errors),
        ),
        Sensor(
            [f"{output}.rate_error" for output in rig.outputs],
            errors / scales.time,
            lambda out: np.copyto(out, loads.rate_errors),
        ),
        Sensor(
            [f"{name}.tension" for name in rig.tension_names],
            scales.weight,
            lambda out: np.copyto(out, loads.tensions),
        ),
    ]
