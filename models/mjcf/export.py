"""Write the catalogue's scenes as XML for plain MuJoCo: `flatrig scenes`.

    overhead_crane.xml         # the machine: what a simulation needs, and sensors
    overhead_crane_scene.xml   # includes it, and adds all that is to be seen: for viewers

Every number of the machine is written exactly as the model was built with it, so a file compiles
to the very model that `compile(rig, visuals=False)` makes, with sensors.  The scene moves as the
machine alone, bit for bit, since it includes that file; what moves is drawn there by skins (see
`looks.skins`), what stands still by geoms of the world.  Only a rope's colour stands with the rope.
Hands have files of their own making, see `hand_export`.
"""

import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from ..files import make_folder, write_text
from ..hand.catalogue import HAND_CATALOGUE
from ..looks.setting import COLOURS, ROPES
from ..looks.skins import Skin, skins
from ..rig.catalogue import CATALOGUE
from ..rig.rig import Rig
from ..types import Array
from . import rigging
from .hand_export import hand_scene_xml, hand_xml
from .rig_model import memory, spec

FOLDER = Path(__file__).parents[1]

COMMENT = "Made from the rig description by `flatrig scenes`."

SEEN = ("statistic", "visual", "default", "asset", "worldbody")
"""Sections of a dressed scene that hold looks."""
STILL = ("geom", "camera", "light")
"""What of the world is looks."""


def xml(rig: Rig) -> str:
    """A rig's machine as MJCF text."""
    scene = spec(rig, visuals=False)
    scene.memory = memory(scene)
    rigging.add_sensors(scene, rig)
    for index, rope in enumerate(rig.ropes):
        scene.tendon(rope.name).rgba = [*COLOURS[ROPES[index % len(ROPES)]], 1]
    scene.comment = COMMENT
    return _tidy(scene.to_xml())


def scene_xml(rig: Rig) -> str:
    """A rig's scene as MJCF text, which includes the file of its machine."""
    dressed = spec(rig)
    tree = ElementTree.fromstring(dressed.to_xml())
    scene = ElementTree.Element("mujoco", model=rig.name)
    scene.append(ElementTree.Comment(COMMENT))
    ElementTree.SubElement(scene, "include", file=f"{rig.name}.xml")
    scene.extend([section for section in tree if section.tag in SEEN])
    for material in scene.findall("asset/material"):
        if material.get("name") in ROPES:
            _section(scene, "asset").remove(material)
    world = _section(scene, "worldbody")
    for part in list(world):
        if part.tag not in STILL:
            world.remove(part)
    moving = ElementTree.SubElement(scene, "deformable")
    for skin in skins(dressed.compile()):
        _add(moving, skin)
    ElementTree.indent(scene)
    text = ElementTree.tostring(scene, encoding="unicode")
    return re.sub(r"\n(?=  <[^/])", "\n\n", text).replace("\n\n  <!--", "\n  <!--", 1) + "\n"


def export(folder: str | Path = FOLDER) -> list[Path]:
    """Write the files of every rig and hand of the catalogues, with their default numbers.

    Raises
    ------
    OutputError
        The folder cannot be written to.
    """
    make_folder(Path(folder))
    files: dict[str, str] = {}
    for name, build in CATALOGUE.items():
        rig = build()
        files |= {name: xml(rig), f"{name}_scene": scene_xml(rig)}
    for name, make in HAND_CATALOGUE.items():
        hand = make()
        files |= {name: hand_xml(hand), f"{name}_scene": hand_scene_xml(hand)}
    for name, text in files.items():
        write_text(Path(folder) / f"{name}.xml", text)
    return [Path(folder) / f"{name}.xml" for name in files]


def _section(scene: ElementTree.Element, tag: str) -> ElementTree.Element:
    return next(section for section in scene if section.tag == tag)


def _add(parent: ElementTree.Element, skin: Skin) -> None:
    count = len(skin.vertices)
    element = ElementTree.SubElement(
        parent,
        "skin",
        name=f"{skin.body}.{skin.material}",
        material=skin.material,
        vertex=_numbers(skin.vertices),
        face=_numbers(skin.faces),
    )
    ElementTree.SubElement(
        element,
        "bone",
        body=skin.body,
        bindpos="0 0 0",  # vertices are in the body's own axes
        bindquat="1 0 0 0",
        vertid=_numbers(np.arange(count, dtype=float)),
        vertweight=_numbers(np.ones(count)),
    )


def _numbers(values: Array) -> str:
    """To a tenth of a millimetre, which nobody sees."""
    return " ".join(f"{round(float(value), 4) + 0.0:g}" for value in values.ravel())


def _tidy(text: str) -> str:
    return re.sub(r"\n\n(?=    )", "\n", text)  # blank lines between sections only


if __name__ == "__main__":
    for written in export(*sys.argv[1:2]):
        print(written)
