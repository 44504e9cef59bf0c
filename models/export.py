"""Write the catalogue's scenes as XML for plain MuJoCo: `python -m flatrig.models.export`.

Every number is written exactly as the model was built with it, so a file compiles to the very
model that `compile` makes.
"""

import re
import sys
from pathlib import Path

from .catalogue import CATALOGUE
from .files import write_text
from .mjcf import spec
from .rig import Rig

FOLDER = Path(__file__).parent


def xml(rig: Rig) -> str:
    """A rig's scene as MJCF text."""
    scene = spec(rig)
    scene.comment = "Made from the rig description by `python -m flatrig.models.export`."
    return re.sub(r"\n\n(?=    )", "\n", scene.to_xml())  # blank lines between sections only


def export(folder: str | Path = FOLDER) -> list[Path]:
    """Write the scene of every rig of the catalogue, with its default numbers, to NAME.xml.

    Raises:
        OutputError: the folder cannot be written to.
    """
    paths = []
    for name, build in CATALOGUE.items():
        path = Path(folder) / f"{name}.xml"
        write_text(path, xml(build()))
        paths.append(path)
    return paths


if __name__ == "__main__":
    for written in export(*sys.argv[1:2]):
        print(written)
