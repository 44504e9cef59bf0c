"""`flatrig scenes`: files for MuJoCo."""

from .. import options
from ..console import console
from ..option_values import output_folder


def main(command: options.Scenes) -> None:
    """Write the catalogue's scenes as XML, cranes and hands."""
    from ...models.mjcf import export

    for path in export.export(output_folder(command.output, str(export.FOLDER))):
        console().print(f"wrote {path}", soft_wrap=True)
