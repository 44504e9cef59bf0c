"""`flatrig drive`: the crane that somebody drives in a page of a browser."""

import math
import os
import sys
import threading
import time
import webbrowser
from dataclasses import fields, replace
from typing import Any

import numpy as np

from ... import feedforward
from ...feedforward.paths.waves import still
from ...models.errors import FlatrigError, OptionError
from ...models.values import as_number, shown
from .. import options
from ..console import console, warning
from ..exits import DONE
from ..option_values import output_folder
from ..policy import Policy
from .recording import Recording
from .session import Session, Wishes
from .sketch import Sketch
from .web import LOOPBACK, Server

EVERY = 2
"""Control periods from one picture to the next."""
SAID = 8.0
"""How long a message stands in the page [s]."""
DEAD = 0.8
"""Without a word of the page for so long, the crane stops [s]."""
FASTEST = 5.0
"""Speed that a page may ask for [m/s, rad/s]."""
STRONGEST = 0.2
"""Wind that a page may ask for, over the loads' weight."""
LIGHTEST, HEAVIEST = 0.5, 1.5
"""Mass that a page may give the load, over the one that is reckoned with."""


class Drive:
    """A session with its page."""

    def __init__(self, command: options.Drive) -> None:
        rig, move = replace(command, duration=None).target()  # which is not the move's here
        path = feedforward.from_move(move, rig)
        policy = Policy.load(command.policy) if command.policy else None
        base = feedforward.base_at(path, 0.0)
        self.session = Session(rig, np.asarray(still(path).start), policy, base)
        self.sketch = Sketch(self.session.task)
        self.folder = output_folder(command.output, f"results/drive-{command.label()}")
        self._strongest = STRONGEST * rig.weight
        self._lock = threading.Lock()
        self._wishes = self.session.wishes
        self._heard = -math.inf
        self._said = "", -math.inf
        self._orders: list[str] = []
        self._recording: Recording | None = None
        self._films: list[threading.Thread] = []
        self._given_up = threading.Event()
        self.server = Server(command.host, command.port, self._about(), self._hear)
        self._pace = 1.0

    def run(self, duration: float, idle: float) -> None:
        """Drive for so long, or until no page has been open for so long [s]; 0 is without end.

        Films are then finished, unless a signal ends it.
        """
        serving = threading.Thread(target=self.server.serve_forever, daemon=True)
        serving.start()
        try:
            self._drive(duration, idle)
        except KeyboardInterrupt:
            console().print("ended")
        except BaseException:
            self._given_up.set()
            raise
        finally:
            self.server.closing = True
            self.server.shutdown()
            self.server.server_close()
            self._stop_recording()
            self._wait_for_films()

    def _drive(self, duration: float, idle: float) -> None:
        """Step after step, as fast as time passes or as fast as can be."""
        begin = next_step = time.monotonic()
        steps = 0
        while True:
            now = time.monotonic()
            if duration and now - begin >= duration:
                return
            if idle and not self.server.pages and now - self.server.last_seen >= idle:
                return
            self._step(now)
            steps += 1
            if steps % EVERY == 0 and self.server.pages:
                self.server.show(self._frame())
            done = time.monotonic()
            self._pace += 0.05 * (min(1.0, self.session.period / (done - now)) - self._pace)
            next_step += self.session.period
            if done < next_step:
                time.sleep(next_step - done)
            else:
                next_step = done  # slower than life, rather than in jerks

    def _wait_for_films(self) -> None:
        """Let films that are being drawn be finished; Ctrl-C gives them up."""
        if any(film.is_alive() for film in self._films):
            console().print("drawing the film (Ctrl-C gives it up)")
        try:
            for film in self._films:
                film.join()
        finally:
            self._given_up.set()
            for film in self._films:
                film.join()
            if self._films:
                console().print(self.session.message, soft_wrap=True)

    def _step(self, now: float) -> None:
        with self._lock:
            wishes, orders, heard = self._wishes, self._orders, self._heard
            self._orders = []
        if now - heard > DEAD:
            wishes = replace(wishes, velocity=(0.0,) * len(wishes.velocity))
        self.session.wishes = wishes
        for order in orders:
            self._obey(order)
        self.session.step()
        if self._recording is not None:
            self._recording.take()

    def _obey(self, order: str) -> None:
        if order == "begin":
            self.session.begin()
            self.session.message = "started anew"
        elif order == "record" and self._recording is None:
            self._recording = Recording(self.session)
            self.session.message = "recording"
        elif order == "record":
            self._stop_recording()

    def _stop_recording(self) -> None:
        recording, self._recording = self._recording, None
        if recording is None:
            return
        number = 1
        while (self.folder / f"drive-{number}.csv").exists():
            number += 1
        stem = self.folder / f"drive-{number}"
        try:
            self.session.message = recording.write(stem.with_suffix(".csv"))
        except FlatrigError as error:
            self.session.message = str(error)
            return
        console().print(self.session.message, soft_wrap=True)
        if not self._given_up.is_set():
            film = recording.film(self.sketch.model, stem, self._given_up)
            self._films.append(film)

    def _hear(self, wanted: dict[str, Any]) -> None:
        """Take in what a page posts.

        Raises
        ------
        OptionError
            It is not what a page can ask for.
        """
        order = wanted.pop("order", None)
        if order not in (None, "begin", "record"):
            raise OptionError(f"order is {shown(order)}, it must be begin or record")
        known = {item.name for item in fields(Wishes)}
        for name in wanted:
            if name not in known:
                raise OptionError(f"there is no wish {name!r}, only {', '.join(sorted(known))}")
        changes = {name: self._checked(name, value) for name, value in wanted.items()}
        with self._lock:
            self._wishes = replace(self._wishes, **changes)
            self._heard = time.monotonic()
            if order:
                self._orders.append(order)

    def _checked(self, name: str, value: Any) -> Any:
        if name == "velocity":
            count = len(self._wishes.velocity)
            if not isinstance(value, list) or len(value) != count:
                raise OptionError(f"velocity is {shown(value)}, it must be {count} numbers")
            return tuple(_within(name, entry, -FASTEST, FASTEST) for entry in value)
        if name == "wind":
            return _within(name, value, 0.0, self._strongest)
        if name == "wind_direction":
            return _within(name, value, -math.tau, math.tau)
        if name == "load_mass":
            return _within(name, value, LIGHTEST, HEAVIEST)
        if not isinstance(value, bool):
            raise OptionError(f"{name} is {shown(value)}, it must be true or false")
        return value

    def _about(self) -> dict[str, Any]:
        session, task = self.session, self.session.task
        rig = session.rig
        return {
            "rig": rig.name,
            "outputs": list(rig.outputs),
            "given": [frame.coordinate for frame in rig.frames if frame.given],
            "drives": list(rig.input_names),
            "units": [feedforward.driven_unit(rig, drive) for drive in rig.drives],
            "limits": task.limits.tolist(),
            "ropes": list(rig.rope_names),
            "dimensions": rig.dimensions,
            "learned": session.learned,
            "wind": self._strongest,
            "mass": [LIGHTEST, HEAVIEST],
            "still": self.sketch.still(session.joints),
            "camera": self.sketch.camera(session.joints),
        }

    def _frame(self) -> dict[str, Any]:
        session, now = self.session, time.monotonic()
        if session.message != self._said[0]:
            self._said = session.message, now
        said = session.message if now - self._said[1] < SAID or self._recording else ""
        state = {name: np.asarray(value).tolist() for name, value in session.state().items()}
        return {
            **state,
            "shapes": self.sketch.moving(session.joints),
            "ghost": self.sketch.ghost(session.planned),
            "pace": round(self._pace, 2),
            "recording": self._recording is not None,
            "message": said,
        }


def main(command: options.Drive) -> int:
    """Serve the page until it is over."""
    for name in ("duration", "idle"):
        options.check_number(f"--{name}", getattr(command, name) or 0.0, open_end=False, unit="s")
    if command.open and not _has_display():
        raise OptionError(
            "--open needs a display for a browser, and there is none; leave it out and open the "
            "page from another machine, through ssh -L"
        )
    drive = Drive(command)
    out = console()
    out.print(f"driving {drive.session.rig.name} at {drive.server.url} (Ctrl-C ends it)")
    if command.host not in LOOPBACK:
        text = f"anyone who reaches {command.host} can drive this crane: there is no password"
        console(stderr=True).print(warning(f"warning: {text}"))
    sys.stdout.flush()
    if command.open:
        webbrowser.open(drive.server.url)
    drive.run(command.duration or 0.0, command.idle)
    return DONE


def _has_display() -> bool:
    if sys.platform != "linux":
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _within(name: str, value: Any, low: float, high: float) -> float:
    number = as_number(value)
    if not low <= number <= high:
        raise OptionError(f"{name} is {shown(value)}, it must be from {low:g} to {high:g}")
    return number
