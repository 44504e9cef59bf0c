"""Write the catalogue's scenes as XML for plain MuJoCo: `flatrig scenes`.

Every number is written exactly as the model was built with it, so a file compiles to the very
model that `compile` makes.
"""

import re
import sys
from pathlib import Path

from ..files import make_folder, write_text
from ..rig.catalogue import CATALOGUE
from ..rig.rig import Rig
from .rig_model import spec

FOLDER = Path(__file__).parents[1]


def xml(rig: Rig) -> str:
    """A rig's scene as MJCF text."""
    scene = spec(rig)
    scene.comment = "Made from the rig description by `flatrig scenes`."
    return re.sub(r"\n\n(?=    )", "\n", scene.to_xml())  # blank lines between sections only


def export(folder: str | Path = FOLDER) -> list[Path]:
    """Write the scene of every rig of the catalogue, with its default numbers, to NAME.xml.

    Raises
    ------
    OutputError
        The folder cannot be written to.
    """
    make_folder(Path(folder))
    paths = []
    for name, build in CATALOGUE.items():
        path = Path(folder) / f"{name}.xml"
        write_text(path, xml(build()))
        paths.append(path)
    return paths


if __name__ == "__main__":
    for written in export(*sys.argv[1:2]):
        print(written)
