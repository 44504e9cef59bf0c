"""`flatrig scenes`: files for MuJoCo."""

from .. import options
from ..console import console


def main(command: options.Scenes) -> None:
    """Write the catalogue's scenes as XML, cranes and hands."""
    from ...models.mjcf import export

    for path in export.export(command.output or export.FOLDER):
        console().print(f"wrote {path}", soft_wrap=True)
