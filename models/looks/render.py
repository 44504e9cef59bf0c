"""Pictures and animations without a display.

    for image in frames(model, qpos, times, camera="overview"): ...
    save_animation("crane.gif", frames(model, qpos, times), fps=25)

MuJoCo draws through EGL or OSMesa, which a machine may or may not have, and whose choice is
final in a process.  So a fresh Python tries them first, once; MUJOCO_GL, if set, decides instead.
"""

import os
import subprocess
import sys
from collections.abc import Iterable, Iterator
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ModelError, OptionError
from ..files import STANDARD_OUTPUT, replacing
from ..forks import hold_in_children, require_drawing_process
from ..types import Array
from ..values import bounded, reals

Image = NDArray[np.uint8]

SLOWEST, FASTEST = 0.01, 1e6
"""Pictures per second: a GIF shows none longer than 655 s, and a million are too many to wait."""

BACKENDS = ("egl", "osmesa")
"""In the order in which they are tried: EGL is several times faster, with or without a GPU."""

_TRIAL = """
import mujoco
model = mujoco.MjSpec().compile()
data = mujoco.MjData(model)
with mujoco.Renderer(model, 8, 8) as renderer:
    renderer.update_scene(data)
    renderer.render()
"""


def frames(
    model: mujoco.MjModel,
    qpos: ArrayLike,
    times: ArrayLike,
    camera: str = "overview",
    width: int = 640,
    height: int = 480,
    fps: float = 25.0,
) -> Iterator[Image]:
    """Pictures of a trajectory at equal intervals of time.

    Parameters
    ----------
    model
        With looks (`compile(rig, visuals=True)`).
    qpos
        Joint positions, shape (N, nq).
    times
        Their times, rising, shape (N,) [s]; joints move linearly in between.
    camera
        "overview" or "side".
    width, height
        Of a picture [pixels].
    fps
        Pictures per second of the trajectory.

    Yields
    ------
    Arrays of shape (height, width, 3).

    Raises
    ------
    ModelError
        Nothing here can draw, or the model has no such camera.
    OptionError
        A size or rate is out of range, shapes do not match, or the times do not rise.
    """
    _check_fps(fps)
    path, clock = _trajectory(model, qpos, times)
    moments = np.arange(clock[0], clock[-1] + 1e-9, 1 / fps)
    data = mujoco.MjData(model)
    with renderer(model, width, height) as drawing:
        for moment in moments:
            data.qpos[:] = [np.interp(moment, clock, column) for column in path.T]
            data.time = moment
            yield draw(drawing, model, data, camera)


def draw(
    drawing: mujoco.Renderer, model: mujoco.MjModel, data: mujoco.MjData, camera: str = "overview"
) -> Image:
    """One picture of the state in `data`, shape (height, width, 3).

    Raises
    ------
    ModelError
        The model has no such camera.
    """
    if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_CAMERA.value, camera) < 0:
        known = [model.camera(index).name for index in range(model.ncam)]
        raise ModelError(
            f"the model has no camera {camera!r}, it has {', '.join(known) or 'none'}"
            f"{'' if known else '; compile it with visuals=True'}"
        )
    mujoco.mj_fwdPosition(model, data)
    drawing.update_scene(data, camera=camera)
    return np.array(drawing.render(), dtype=np.uint8)


def renderer(model: mujoco.MjModel, width: int = 640, height: int = 480) -> mujoco.Renderer:
    """An offscreen `mujoco.Renderer` on whatever works here; close it, or use it in a `with`.

    Raises
    ------
    ModelError
        Nothing works; says what to install.  Or this process was forked from one that draws.
    OptionError
        The size is not between 1 and the model's offscreen buffer.
    """
    room = model.vis.global_
    if not (0 < width <= room.offwidth and 0 < height <= room.offheight):
        raise OptionError(
            f"a picture of {width} x {height} pixels is not possible, "
            f"it must be between 1 x 1 and {room.offwidth} x {room.offheight}"
        )
    require_drawing_process()
    _use(backend())
    try:
        drawing = mujoco.Renderer(model, height, width)
        hold_in_children(drawing)
        return drawing
    except Exception as error:
        reason = " ".join(str(error).split())
        raise ModelError(
            f"cannot draw with {backend() or 'glfw'}, is MUJOCO_GL set right? {reason}"
        ) from None


@lru_cache(maxsize=1)
def backend() -> str:
    """Name of the OpenGL backend that works here: MUJOCO_GL if set, else egl or osmesa.

    Raises
    ------
    ModelError
        None works.
    """
    chosen = os.environ.get("MUJOCO_GL", "").lower().strip()
    if chosen or sys.platform != "linux":
        return chosen
    for name in BACKENDS:
        if _imported(name) or _works(name):
            return name
    raise ModelError(
        "cannot draw: neither EGL nor OSMesa works here; install one of them, "
        "e.g. `apt-get install libegl1` or `apt-get install libosmesa6`"
    )


def save_animation(path: str | Path, images: Iterable[Image], fps: float = 25.0) -> Path:
    """Write pictures as GIF or, where imageio-ffmpeg is installed, MP4, by the file's ending.

    "-" is standard output, for a GIF.

    Raises
    ------
    OptionError
        The ending is another one, imageio-ffmpeg is missing, there is no picture, or
        the rate is out of range.
    OutputError
        The file cannot be written.
    """
    ending = ".gif" if path == STANDARD_OUTPUT else Path(path).suffix.lower()
    writers = {".gif": _write_gif, ".mp4": _write_mp4}
    if ending not in writers:
        raise OptionError(f"cannot write {Path(path).name}: the ending must be .gif or .mp4")
    _check_fps(fps)
    with replacing(path) as beside:
        writers[ending](beside, iter(images), fps)
    return Path(path)


def _write_gif(path: Path, images: Iterator[Image], fps: float) -> None:
    from PIL import Image as Pillow

    pictures = [
        Pillow.fromarray(image).quantize(
            128, method=Pillow.Quantize.FASTOCTREE, dither=Pillow.Dither.NONE
        )
        for image in images
    ]
    if not pictures:
        raise OptionError("there is no picture to write")
    # a GIF counts in hundredths of a second: round the moments, not the intervals
    moments = np.round(np.arange(len(pictures) + 1) * 100 / fps) * 10
    pictures[0].save(
        path,
        "GIF",
        save_all=True,
        append_images=pictures[1:],
        duration=np.maximum(np.diff(moments), 20).astype(int).tolist(),
        loop=0,
        optimize=False,
    )


def _write_mp4(path: Path, images: Iterator[Image], fps: float) -> None:
    try:
        ffmpeg: Any = import_module("imageio_ffmpeg")
    except ImportError:
        raise OptionError(
            "an MP4 needs imageio-ffmpeg: `pip install imageio-ffmpeg`, or write a .gif"
        ) from None
    first = next(images, None)
    if first is None:
        raise OptionError("there is no picture to write")
    height, width = first.shape[:2]
    writer = ffmpeg.write_frames(str(path), (width, height), fps=fps, macro_block_size=2)
    writer.send(None)
    try:
        writer.send(np.ascontiguousarray(first))
        for image in images:
            writer.send(np.ascontiguousarray(image))
    finally:
        writer.close()


def _check_fps(fps: float) -> None:
    rule = f"> 0 (from {SLOWEST:g} to {FASTEST:g} pictures per second)"
    bounded("fps", fps, least=SLOWEST, most=FASTEST, rule=rule)


def _trajectory(model: mujoco.MjModel, qpos: ArrayLike, times: ArrayLike) -> tuple[Array, Array]:
    """Joint positions (N, nq) and their rising times (N,), one or more."""
    path, clock = reals("qpos", qpos, error=OptionError), reals("times", times, error=OptionError)
    if clock.ndim != 1 or len(clock) == 0:
        raise OptionError(f"times have shape {clock.shape}, they need shape (N,) with N >= 1")
    if path.shape != (len(clock), model.nq):
        raise OptionError(
            f"qpos has shape {path.shape}, it must be ({len(clock)}, {model.nq}): "
            "one row for each time"
        )
    if not (np.isfinite(path).all() and np.isfinite(clock).all()):
        raise OptionError("qpos and times must be finite")
    if (np.diff(clock) < 0).any():
        raise OptionError("times must rise")
    return path, clock


def _imported(name: str) -> bool:
    """Whether this process has a backend's module already."""
    return f"mujoco.{name}" in sys.modules


def _works(name: str) -> bool:
    """Whether a fresh Python can draw with a backend."""
    environment = {key: value for key, value in os.environ.items() if key != "PYOPENGL_PLATFORM"}
    environment["MUJOCO_GL"] = name
    command = [sys.executable, "-c", _TRIAL]
    try:
        trial = subprocess.run(
            command, env=environment, capture_output=True, timeout=60, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return trial.returncode == 0


def _use(name: str) -> None:
    """Let MuJoCo, which chose its context class when it was imported, use this one instead."""
    if name in BACKENDS:
        from mujoco.rendering.classic import gl_context

        try:
            gl_context.GLContext = import_module(f"mujoco.{name}").GLContext
        except ImportError as error:
            raise ModelError(f"cannot draw with {name}: {error}") from None
