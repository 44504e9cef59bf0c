"""Pictures for `render`: made of a copy of a simulation's state, in a model with looks."""

from typing import Any

import mujoco
from numpy.typing import NDArray

from ..models.errors import OptionError
from ..models.values import shown

MODES = ("rgb_array", "human")
"""Pictures as arrays, or a window."""


class Camera:
    """Shows joints of a model, as an array ("rgb_array") or in a window ("human")."""

    def __init__(self, model: mujoco.MjModel, mode: str) -> None:
        from ..models.looks import render  # only here: finding a backend for drawing takes a second

        self._draw = render.draw
        self._model = model
        self._data = mujoco.MjData(self._model)
        self._window: Any = None
        self._drawing: Any = None
        if mode == "human":
            self._window = _window(self._model, self._data)
        else:
            self._drawing = render.renderer(self._model)

    def show(self, joints: NDArray[Any]) -> Any:
        """A picture (height, width, 3) of bytes, or None where there is a window."""
        self._data.qpos[:] = joints
        if self._window is None:
            return self._draw(self._drawing, self._model, self._data)
        mujoco.mj_fwdPosition(self._model, self._data)
        self._window.sync()
        return None

    def close(self) -> None:
        """Close the window or give back the renderer."""
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
    import mujoco.viewer

    try:
        return mujoco.viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False)
    except Exception as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise OptionError(
            f'no window can be opened for render_mode "human" ({reason}); use "rgb_array"'
        ) from None
