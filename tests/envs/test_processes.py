"""What a process may lack: threads and drawing after `os.fork`, a display for a window.

Each case runs in a Python of its own, and a child that waits for ever is ended by its alarm.
"""

import os
import subprocess
import sys

import gymnasium as gym
import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import models
from flatrig.envs import rendering

needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")

FORK = """
import gc, os, signal, sys
import gymnasium as gym, numpy as np
import flatrig.envs as envs
from flatrig.models import FlatrigError

def child(work):
    sys.stdout.flush()
    pid = os.fork()
    if pid:
        return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    signal.alarm(30)
    try:
        work()
    except FlatrigError as error:
        print(error)
    sys.exit(0)                      # the usual end, with all destructors
"""

THREADS = (
    FORK
    + """
NAME, ACTION = "flatrig/OverheadCrane-v0", [0.01, -0.49]
threads = gym.make_vec(NAME, num_envs=4, nthread=2)
caller = gym.make_vec(NAME, num_envs=4, nthread=1)
single, wrapped = gym.make(NAME), envs.Feedforward(envs.PD(threads))
for env in (threads, caller, single):
    env.reset(seed=0)
many = np.tile(ACTION, (4, 1))

def last():
    global threads, wrapped
    threads.close()
    del threads, wrapped
    gc.collect()

def anew():
    new = gym.make_vec(NAME, num_envs=4, nthread=2)
    new.reset(seed=0)
    print(new.step(many)[1].tolist())

for work in (
    lambda: threads.step(many), lambda: threads.reset(seed=0), lambda: wrapped.step(many), last,
    lambda: print(caller.step(many)[1].tolist()), lambda: print(single.step(ACTION)[1]), anew,
):
    print("ended", child(work))
for env in (threads, caller):
    print(env.step(many)[1].tolist())
"""
)

DRAWING = (
    FORK
    + """
env = gym.make("flatrig/OverheadCrane-v0", render_mode="rgb_array")
env.reset(seed=0)
print("ended", child(lambda: print(env.render().shape)))
env.render()
print("ended", child(env.render))
print("ended", child(env.close))
"""
)


def run(script: str) -> list[str]:
    """The lines that a script prints in a Python of its own, which must come to its end."""
    known = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    python = [sys.executable, "-W", "ignore", "-c", script]
    done = subprocess.run(python, env=known, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@needs_fork
def test_threads_are_missed_at_once_after_a_fork():
    lines = run(THREADS)
    task = envs.CraneTask("overhead_crane", num=4, nthread=1)
    task.reset(task.all, [np.random.default_rng(seed) for seed in range(4)])
    rewards = task.step(np.tile([0.01, -0.49], (4, 1))).reward.tolist()
    for line in lines[:6:2]:
        assert line.startswith("this environment was made in process ")
    assert lines[1:6:2] == ["ended 0"] * 3
    assert lines[6] == "ended 0"
    of_children = [str(rewards), "ended 0", str(rewards[0]), "ended 0", str(rewards), "ended 0"]
    assert lines[7:] == [*of_children, str(rewards), str(rewards)]


@needs_fork
def test_a_child_of_a_process_that_draws_does_not():
    first, *rest = run(DRAWING)
    assert first == "(480, 640, 3)"
    assert rest[0] == "ended 0"
    assert "which was forked from one that draws" in rest[1]
    assert rest[2:] == ["ended 0", "ended 0"]


WINDOW = """
import os
import gymnasium as gym, flatrig.envs
for display in (None, ":987654"):
    if display:
        os.environ["DISPLAY"] = display
    env = gym.make("flatrig/OverheadCrane-v0", render_mode="human")
    try:
        env.reset(seed=0)
    except flatrig.models.OptionError as error:
        print(error)
    env.close()
"""


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have a display, or say so")
def test_without_a_display_there_is_no_window_but_a_process():
    lines = run(WINDOW)
    reasons = ("DISPLAY environment variable is missing", "Failed to open display :987654")
    for line, reason in zip(lines, reasons, strict=True):
        assert line.startswith('no window can be opened for render_mode "human" (')
        assert reason in line
        assert line.endswith('; use "rgb_array"')


class Window:
    """What MuJoCo's viewer gives."""

    def __init__(self, *_, **__):
        self.shown, self.closed = 0, False

    def sync(self):
        self.shown += 1

    def close(self):
        self.closed = True


def test_with_a_display_every_step_is_shown(monkeypatch):
    viewer = pytest.importorskip("mujoco.viewer")
    windows = []
    launch = lambda *args, **options: windows.append(Window()) or windows[-1]  # noqa: E731
    monkeypatch.setattr(viewer, "launch_passive", launch)
    monkeypatch.setattr(rendering, "_no_window", lambda: "")
    env = gym.make("flatrig/OverheadCrane-v0", render_mode="human")
    env.reset(seed=0)
    env.step([0.0, -0.49])
    env.close()
    assert [(window.shown, window.closed) for window in windows] == [(2, True)]


def test_a_window_that_fails_to_open_is_one_line(monkeypatch):
    viewer = pytest.importorskip("mujoco.viewer")

    def launch(*_, **__):
        raise RuntimeError("needs\nmjpython")

    monkeypatch.setattr(viewer, "launch_passive", launch)
    monkeypatch.setattr(rendering, "_no_window", lambda: "")
    env = gym.make("flatrig/OverheadCrane-v0", render_mode="human")
    with pytest.raises(models.OptionError, match=r"\(needs mjpython\); use \"rgb_array\""):
        env.reset(seed=0)
