"""What has made a value: the sources, the libraries and the kind of machine, as one hash."""

import hashlib
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGE = Path(__file__).parents[1]
ROOMS = ("models", "feedforward", "envs", "training")
"""Folders of the package whose sources may decide on a value."""
SOURCES = (".py", ".json", ".safetensors")
"""Endings of these sources: code, and the policies that it reads."""
LIBRARIES = ("mujoco", "numpy", "scipy", "gymnasium", "casadi", "scikit-sundae", "cranebench")
"""Libraries whose versions may, too; those that are not installed count as that."""


@cache
def sources() -> str:
    """Hash of the package's sources, of what they compute with, and of the kind of machine."""
    used = [platform.python_version(), platform.machine(), *map(_version, LIBRARIES)]
    digest = hashlib.sha256(repr(used).encode())
    for room in ROOMS:
        for path in sorted((PACKAGE / room).rglob("*")):
            if path.suffix in SOURCES and path.is_file():
                content = hashlib.sha256(path.read_bytes()).hexdigest()
                digest.update(f"{path.relative_to(PACKAGE)}: {content}\n".encode())
    return digest.hexdigest()[:16]


def _version(library: str) -> str:
    try:
        return version(library)
    except PackageNotFoundError:
        return ""
