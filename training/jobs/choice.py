"""The back end that an option `--on` names."""

import importlib.util
import shutil
from collections.abc import Callable
from pathlib import Path

from ...models.errors import OptionError, did_you_mean
from .crews import Backend
from .on_ray import Ray
from .on_slurm import Slurm
from .processes import Processes

PACKAGES = {"local": "", "ray": "ray", "slurm": "submitit", "slurm-local": "submitit"}
"""Package that each back end needs, by the back end's name."""


def backend_for(
    name: str,
    count: int,
    folder: Path,
    *,
    begin: Callable[[], None] | None = None,
    cores: int = 1,
) -> Backend:
    """The back end of this name.

    Parameters
    ----------
    name
        local, ray, slurm, or slurm-local, which is the latter without a cluster.
    count
        Number of processes or jobs side by side; a cluster of Ray's does as many as it can.
    folder
        Result folder, in which Slurm's jobs have a folder of their own.
    begin
        Function that every process calls first.
    cores
        Cores for each item, where that is told.

    Raises
    ------
    OptionError
        There is none of this name, or it is not installed.
    """
    if name not in PACKAGES:
        raise OptionError(f"--on is {name!r}, which is no back end{did_you_mean(name, PACKAGES)}")
    package, extra = PACKAGES[name], name.partition("-")[0]
    if package and importlib.util.find_spec(package) is None:
        raise OptionError(f"--on {name} needs {package}: pip install 'flatrig[{extra}]'")
    if name == "slurm" and not shutil.which("sbatch"):
        raise OptionError("--on slurm finds no sbatch; call it where Slurm takes jobs")
    if name == "ray":
        return Ray(count, begin, cores)
    if name == "local":
        return Processes(count, begin)
    cluster = "slurm" if name == "slurm" else "local"
    return Slurm(folder / "slurm", count, begin, cores, cluster)
