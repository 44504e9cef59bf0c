"""Pictures for `render`: made of a copy of a simulation's state, in a model with looks."""

import subprocess
import sys
from typing import Any, NamedTuple

import mujoco
from numpy.typing import NDArray

from ..models.errors import OptionError
from ..models.forks import may_draw, require_drawing_process
from ..models.values import bounded, shown

MODES = ("rgb_array", "human")
"""Pictures as arrays, or a window."""


PATIENCE = 30.0
"""How long a display may take to show that it is there [s]."""

_TRIAL = """
import sys, glfw
glfw.set_error_callback(lambda code, text: print(text.decode(), flush=True))
if not glfw.init():
    sys.exit(1)
glfw.window_hint(glfw.VISIBLE, False)
sys.exit(not glfw.create_window(8, 8, "trial", None, None))
"""


class View(NamedTuple):
    """What a picture shows, and how large it is; options of environments."""

    width: int = 640
    """[pixels]"""
    height: int = 480
    """[pixels]"""
    camera: str = "overview"
    """"overview" or "side"."""


def view_of(options: dict[str, Any]) -> View:
    """Take what belongs to a `View` out of options.

    Raises
    ------
    OptionError
        A size is not a whole number >= 1, or the camera no name.
    """
    view = View(**{name: options.pop(name) for name in View._fields if name in options})
    for name in ("width", "height"):
        bounded(name, getattr(view, name), least=1, whole=True, unit="pixels")
    if not isinstance(view.camera, str):
        raise OptionError(f"camera is {shown(view.camera)}, it must be the name of one")
    return view


class Camera:
    """Shows joints of a model, as an array ("rgb_array") or in a window ("human").

    Raises
    ------
    ModelError
        Nothing here can draw, or this process was forked from one that draws.
    OptionError
        There is no display for a window.
    """

    def __init__(self, model: mujoco.MjModel, mode: str, view: View) -> None:
        from ..models.looks import render  # only here: finding a backend for drawing takes a second

        self._draw, self._view = render.draw, view
        self._model = model
        self._data = mujoco.MjData(self._model)
        self._window: Any = None
        self._drawing: Any = None
        require_drawing_process()
        if mode == "human":
            self._window = _window(self._model, self._data)
        else:
            self._drawing = render.renderer(self._model, int(view.width), int(view.height))

    def show(self, joints: NDArray[Any]) -> Any:
        """A picture (height, width, 3) of bytes, or None where there is a window.

        Raises
        ------
        ModelError
            This process was forked from the one that draws.
        """
        require_drawing_process()
        self._data.qpos[:] = joints
        if self._window is None:
            return self._draw(self._drawing, self._model, self._data, self._view.camera)
        mujoco.mj_fwdPosition(self._model, self._data)
        self._window.sync()
        return None

    def close(self) -> None:
        """Close the window or give back the renderer, unless they are another process's."""
        if not may_draw():
            return
        if self._window is not None:
            self._window.close()
        if self._drawing is not None:
            self._drawing.close()


def check_mode(mode: str | None, known: tuple[str, ...] = MODES) -> str | None:
    """The option `render_mode`.

    Raises
    ------
    OptionError
        There is no such mode.
    """
    if mode not in (None, *known):
        raise OptionError(f"render_mode is {shown(mode)}, it must be {' or '.join(known)}, or None")
    return mode


def _window(model: mujoco.MjModel, data: mujoco.MjData) -> Any:
    """A passive viewer.

    Raises
    ------
    OptionError
        There is no display.
    """
    reason = _no_window()
    try:
        if not reason:
            import mujoco.viewer

            options = {"show_left_ui": False, "show_right_ui": False}
            return mujoco.viewer.launch_passive(model, data, **options)
    except Exception as error:
        reason = " ".join(str(error).split()) or type(error).__name__
    raise OptionError(
        f'no window can be opened for render_mode "human" ({reason}); use "rgb_array"'
    )


def _no_window() -> str:
    """Why GLFW can open no window here, "" if it can: tried in a fresh Python.

    MuJoCo's viewer ends the whole process where there is no display, so it cannot be asked.
    """
    try:
        trial = subprocess.run(
            [sys.executable, "-c", _TRIAL],
            capture_output=True, text=True, timeout=PATIENCE, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"the display does not answer in {PATIENCE:g} s"
    except OSError as error:
        return f"{error.strerror}"
    if trial.returncode == 0:
        return ""
    said = trial.stdout.split("\n")[0] or trial.stderr.strip().split("\n")[-1]
    return said or "there is no display"
