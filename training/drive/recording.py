"""What was driven, as a table and as a film."""

import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from ...models.errors import FlatrigError
from ...models.files import OutputError, replacing
from .session import Session

FPS = 25.0
"""Pictures of a film per second."""


class Recording:
    """Collects a session's numbers, step by step, and writes them."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._rows: list[Any] = []
        self._joints: list[Any] = []
        rig = session.rig
        of = {"load": rig.outputs, "reference": rig.outputs, "wanted": rig.outputs,
              "velocity": rig.outputs, "tension": rig.rope_names, "input": rig.input_names,
              "drive": rig.input_names}  # fmt: skip
        self.columns = ["time", *(f"{name}.{what}" for what in of for name in of[what])]
        """Names of the table's columns, in SI units."""

    def take(self) -> None:
        """The present instant."""
        state = self._session.state()
        self._rows.append(np.hstack([np.ravel(value) for value in state.values()]))
        self._joints.append(self._session.joints)

    def write(self, path: Path) -> str:
        """Write the table; returns what to say.

        Raises
        ------
        OutputError
            The file cannot be written.
        """
        with replacing(path) as beside:
            table = np.array(self._rows).reshape(-1, len(self.columns))
            np.savetxt(beside, table, "%.9g", ",", header=",".join(self.columns), comments="")
        return f"wrote {path}: {len(self._rows)} rows"

    def film(
        self, model: mujoco.MjModel, stem: Path, given_up: threading.Event
    ) -> threading.Thread:
        """Draw the film beside the driving; the session's message tells the end of it."""

        def work() -> None:
            from ...models.looks import render

            path = stem.with_suffix(".mp4" if _has_mp4() else ".gif")
            times = self._session.period * np.arange(len(self._joints))
            try:
                images = render.frames(model, np.array(self._joints), times, fps=FPS)
                render.save_animation(path, _until(images, given_up), FPS)
            except FlatrigError as error:
                self._session.message = f"no film: {error}"
            else:
                self._session.message = f"wrote {path}"

        thread = threading.Thread(target=work, daemon=True)
        thread.start()
        return thread


def _until(images: Iterator[Any], given_up: threading.Event) -> Iterator[Any]:
    """Pictures, unless nobody waits for the film any more.

    Raises
    ------
    OutputError
        Nobody does.
    """
    for image in images:
        if given_up.is_set():
            raise OutputError("given up before it was finished")
        yield image


def _has_mp4() -> bool:
    try:
        import imageio_ffmpeg  # noqa: F401
    except ImportError:
        return False
    return True
