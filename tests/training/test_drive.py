"""`flatrig drive`: by a real browser's keys, sliders and buttons, and by what a page may post."""

import importlib.util
import json
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.training import cli, options
from flatrig.training.drive.drive_cranes import Drive
from flatrig.training.drive.session import Session

CHROMIUM = None
if importlib.util.find_spec("websockets"):
    import chromium

    CHROMIUM = chromium.executable()
PATIENCE = 90.0


@contextmanager
def driven(tmp_path, *more):
    """A crane in a process of its own; its page, and the process."""
    command = [sys.executable, "-c", "import sys; from flatrig.training.cli import main; "
               "sys.exit(main(sys.argv[1:]))", "drive", "rotary", "--port", "0",
               "--duration", "300", *more]  # fmt: skip
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=tmp_path
    )
    try:
        found = re.search(r"http://\S+/", process.stdout.readline())
        yield found[0], process
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


def post(url, wish, **headers):
    """The status and the text that a post gets."""
    body = wish if isinstance(wish, bytes) else json.dumps(wish).encode()
    request = urllib.request.Request(url + "wishes", body, headers)
    try:
        with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium, and the package websockets")
def test_a_browser_drives_the_load(tmp_path):
    with driven(tmp_path, "--output", "out") as (url, process):
        page = chromium.Chromium(tmp_path / "profile", url)
        try:
            start = page.wait("window.driven && window.driven.frames > 3 && window.driven.load")
            page.wait("!document.getElementById('message').textContent")
            page.mouse("mousePressed", *page.middle("#record"))
            page.mouse("mouseReleased", *page.middle("#record"))
            page.wait("document.getElementById('record').textContent === 'End recording'")
            page.key("keyDown", "ArrowUp")
            page.wait(f"window.driven.load[1] > {start[1] + 0.15}")
            x, y = page.middle("[data-output='load.z']")
            page.mouse("mousePressed", x, y)
            page.mouse("mouseMoved", x + 60.0, y)
            page.wait(f"window.driven.load[2] > {start[2] + 0.1}")
            page.mouse("mouseReleased", x + 60.0, y)
            page.key("keyUp", "ArrowUp")
            error = page.value("document.getElementById('error').textContent")
            assert float(error.split()[1]) < 1.0
            assert page.picture()[1:4] == b"PNG"
            # The canvas shows something: not one colour alone.
            assert page.value(COLOURS) > 20
        finally:
            page.close()
        process.send_signal(signal.SIGTERM)  # no time for a film
        process.wait(PATIENCE)
    (table,) = (tmp_path / "out").iterdir()  # and nothing half-written
    rows = np.genfromtxt(table, delimiter=",", names=True, deletechars="")
    load, planned = (
        np.array([rows[f"load.{axis}.{what}"] for axis in "xyz"]) for what in ("load", "reference")
    )
    assert np.abs(load - planned).max() < 1e-3
    assert np.ptp(load[1]) > 0.15
    assert np.ptp(load[2]) > 0.1
    assert np.ptp(load[0]) < 1e-3
    assert rows["hoist.tension"].min() > 0


COLOURS = """(() => {
  const view = document.getElementById('view'), flat = document.createElement('canvas');
  flat.width = 64; flat.height = 64;
  const pen = flat.getContext('2d');
  pen.drawImage(view, 0, 0, 64, 64);
  return new Set(new Uint32Array(pen.getImageData(0, 0, 64, 64).data.buffer)).size;
})()"""


def test_what_a_page_may_not_ask_gets_one_line(tmp_path):
    command = options.Drive("rotary", port=0, output=str(tmp_path))
    drive = Drive(command)
    url = drive.server.url
    thread = threading.Thread(target=drive.server.serve_forever, daemon=True)
    thread.start()
    try:
        for wish, said in (
            ({"velocity": [1.0, 0.0]}, "it must be 3 numbers"),
            ({"velocity": [1.0, 0.0, "a"]}, "velocity is 'a'"),
            ({"velocity": [1e9, 0.0, 0.0]}, "from -5 to 5"),
            (b'{"velocity": [NaN, 0, 0]}', "from -5 to 5"),
            ({"load_mass": 20.0}, "from 0.5 to 1.5"),
            ({"feedback": 1}, "true or false"),
            ({"winds": 1}, "no wish 'winds'"),
            ({"order": "jump"}, "begin or record"),
            (b"[1]", "JSON object"),
            (b"nonsense", "Expecting value"),
        ):
            status, text = post(url, wish)
            assert status == 400
            assert said in text
            assert "\n" not in text
        assert post(url, {}, Origin="http://elsewhere.example")[0] == 403
        assert post(url, {}, Host="elsewhere.example")[0] == 403
        assert post(url, b" " * 20_000)[0] == 403
        with pytest.raises(urllib.error.HTTPError, match="404"):
            urllib.request.urlopen(url + "../../etc/passwd", timeout=PATIENCE)
        assert post(url, {"velocity": [0.5, 0.0, 0.0], "wind": 10.0})[0] == 200
        drive._step(time.monotonic())
        assert drive.session.wishes.velocity == (0.5, 0.0, 0.0)
        assert drive.session.wishes.wind == 10.0
        drive._step(time.monotonic() + 1.0)  # the page has gone: the crane stops
        assert drive.session.wishes.velocity == (0.0, 0.0, 0.0)
        for name in ("", "panel.js", "view.js", "page.css", "about"):
            assert urllib.request.urlopen(url + name, timeout=PATIENCE).status == 200
    finally:
        drive.server.shutdown()
        drive.server.server_close()


def test_a_session_ends_by_itself(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["drive", "overhead", "--port", "0", "--duration", "0.2"]) == 0
    assert cli.main(["drive", "overhead", "--port", "0", "--idle", "0.2"]) == 0
    out = capsys.readouterr().out
    assert out.count("driving overhead_crane at http://127.0.0.1:") == 2
    assert not list(tmp_path.iterdir())


def test_mistakes_get_one_line(capsys, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        for argv, said in (
            (["rotry"], "rotary_crane"),
            (["two_finger_hand"], "for cranes only"),
            (["rotary", "--port", port], f"port {port} of 127.0.0.1 is in use"),
            (["rotary", "--port", "99999"], "from 0 to 65535"),
            (["rotary", "--host", "203.0.113.7"], "no address of this machine"),
            (["rotary", "--duration", "-1"], "--duration is -1"),
            (["rotary", "--policy", "none.json"], "none"),
            (["rotary", "--start", "50", "0", "-5"], "cannot"),
        ):
            assert cli.main(["drive", *argv]) == 2
            out, err = capsys.readouterr()
            assert err.count("\n") == 1
            assert err.startswith("flatrig: error: ")
            assert said in err
            assert not out
    if sys.platform == "linux":
        assert cli.main(["drive", "rotary", "--open", "--port", "0"]) == 2
        assert "no" in capsys.readouterr().err


def test_a_warning_where_others_can_drive(capsys):
    assert cli.main(["drive", "overhead", "--port", "0", "--host", "0.0.0.0", "--idle", "0.1"]) == 0
    out, err = capsys.readouterr()
    assert "no password" in err
    assert "http://0.0.0.0:" in out


def go(session, steps, **wishes):
    """Drive on; the largest error of the load."""
    session.wishes = replace(session.wishes, **wishes)
    most = 0.0
    for _ in range(steps):
        session.step()
        state = session.state()
        most = max(most, float(np.abs(state["load"] - state["reference"]).max()))
    return most


def test_switches_and_disturbances_do_what_they_say():
    rig = models.rotary_crane()
    start = np.asarray(feedforward.from_move(models.default_move(rig)).start)
    session = Session(rig, start)
    assert session.learned
    assert go(session, 40, velocity=(0.0, 0.5, 0.2)) < 1e-3
    alone = go(session, 20, feedback=False)
    assert alone < 1e-3  # open loop, for a short while
    assert go(session, 20, feedback=True) < 1e-3
    heavy = go(session, 60, load_mass=1.2)
    assert heavy > 2e-2
    tension = session.state()["tension"][0]
    assert tension == pytest.approx(1.2 * 981.0, rel=0.1)
    go(session, 120, estimate=True)
    assert go(session, 20) < 0.5 * heavy
    assert not session.message
    with_residual = go(session, 20, residual=True)
    assert np.isfinite(with_residual)
    assert go(session, 50, wind=40.0, load_mass=1.0) > 2e-2
    session.begin()
    assert session.state()["load"] == pytest.approx(start)
    for _ in range(600):  # nothing holds the load any more: it ends, and all begins anew
        session.wishes = replace(session.wishes, feedforward=False, feedback=False, load_mass=0.5)
        session.step()
        if session.message:
            break
    assert session.message.endswith("started anew")


def test_a_film_and_a_table_of_what_was_driven(tmp_path):
    if os.environ.get("MUJOCO_GL") == "disable":
        pytest.skip("nothing here can draw")
    drive = Drive(options.Drive("overhead", port=0, output=str(tmp_path)))
    try:
        drive._obey("record")
        drive._hear({"velocity": [0.5, 0.0]})
        for _ in range(4):
            drive._step(time.monotonic())
        drive._obey("record")
    finally:
        drive.server.server_close()
    drive._wait_for_films()
    table = np.loadtxt(tmp_path / "drive-1.csv", delimiter=",", skiprows=1)
    assert table.shape[0] == 4
    assert table[-1, 0] == pytest.approx(4 * 0.02)
    said = drive.session.message
    assert said.startswith("wrote") == any(
        (tmp_path / f"drive-1{ending}").exists() for ending in (".mp4", ".gif")
    )
    assert said.startswith(("wrote", "no film"))
