"""What a command found, as JSON for scripts: on stdout, with nothing else.

    show_json({"rig": "overhead_crane", "duration_s": 3.0, "tension_N": math.nan})

JSON knows neither NaN nor infinity: null stands for a number that there is not.
"""

import json
import math
import sys
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from typing import Any

import numpy as np


def show_json(facts: Mapping[str, Any]) -> None:
    """Print some facts."""
    sys.stdout.write(json_text(facts))


def json_text(facts: Mapping[str, Any]) -> str:
    """Some facts as JSON, with a line's end."""
    return json.dumps(plain(facts), indent=2, allow_nan=False) + "\n"


def plain(value: Any) -> Any:
    """The same in what JSON knows: of mappings, sequences, arrays and dataclasses all entries."""
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if is_dataclass(value) and not isinstance(value, type):
        return plain(asdict(value))
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
