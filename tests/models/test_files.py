"""What is written replaces a plain file whole, keeps its mode, and replaces nothing else."""

import os
import signal
import stat
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from flatrig.models.files import (
    Ended,
    OutputError,
    append_text,
    make_folder,
    replacing,
    reserving_standard_output,
    unwinding,
    write_text,
)

ROOT = hasattr(os, "geteuid") and os.geteuid() == 0


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_a_plain_file_keeps_its_mode_and_owner(tmp_path: Path) -> None:
    path = tmp_path / "private.csv"
    path.write_text("old")
    for bits in (0o600, 0o640, 0o755):
        path.chmod(bits)
        if ROOT:
            os.chown(path, 1234, 4321)
        write_text(path, "new")
        assert mode(path) == bits
        if ROOT:
            assert (path.stat().st_uid, path.stat().st_gid) == (1234, 4321)
    assert path.read_text() == "new"
    assert [file.name for file in tmp_path.iterdir()] == ["private.csv"]


@pytest.mark.parametrize("mask", [0o022, 0o077, 0o002])
def test_a_new_file_has_the_mode_of_the_umask(mask: int, tmp_path: Path) -> None:
    before = os.umask(mask)
    try:
        write_text(tmp_path / "new" / "table.csv", "new")
    finally:
        assert os.umask(before) == mask
    assert mode(tmp_path / "new" / "table.csv") == 0o666 & ~mask


def test_nobody_else_reads_a_private_file_while_it_is_written(tmp_path: Path) -> None:
    path = tmp_path / "private.csv"
    path.touch(0o600)
    with replacing(path) as beside:
        assert mode(beside) == 0o600


def test_a_read_only_file_is_refused_and_kept(tmp_path: Path) -> None:
    path = tmp_path / "kept.csv"
    path.write_text("old")
    path.chmod(0o444)
    with pytest.raises(OutputError, match=r"cannot write .*kept\.csv: it is read-only"):
        write_text(path, "new")
    with pytest.raises(OutputError, match="read-only"):
        append_text(path, "new")
    assert path.read_text() == "old"
    assert mode(path) == 0o444


def test_a_link_leads_to_its_target(tmp_path: Path) -> None:
    target, link = tmp_path / "there" / "target.csv", tmp_path / "link.csv"
    (tmp_path / "there").mkdir()
    link.symlink_to(Path("there") / "target.csv")
    for text in ("made through the link", "replaced through the link"):
        write_text(link, text)
        assert link.is_symlink()
        assert target.read_text() == text
    target.chmod(0o444)
    with pytest.raises(OutputError, match="read-only"):
        write_text(link, "new")
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    with pytest.raises(OutputError, match="cannot write"):
        write_text(loop, "new")


def test_a_pipe_gets_what_is_written_once_it_is_whole(tmp_path: Path) -> None:
    pipe, read = tmp_path / "pipe.csv", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: read.append(pipe.read_bytes()))
    reader.start()
    write_text(pipe, "through the pipe")
    reader.join(timeout=20)
    assert read == [b"through the pipe"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert [file.name for file in tmp_path.iterdir()] == ["pipe.csv"]


@pytest.mark.skipif(not ROOT, reason="only root makes a device")
def test_a_device_stays_a_device(tmp_path: Path) -> None:
    device = tmp_path / "null"
    try:
        os.mknod(device, 0o640 | stat.S_IFCHR, os.makedev(1, 3))
        device.read_bytes()
    except OSError:
        pytest.skip("no devices may be made or used here")
    link = tmp_path / "link.csv"
    link.symlink_to(device)
    for path in (device, link):
        write_text(path, "away with it")
        append_text(path, "and this")
        assert stat.S_ISCHR(device.stat().st_mode)
    assert mode(device) == 0o640
    assert sorted(file.name for file in tmp_path.iterdir()) == ["link.csv", "null"]


def test_what_is_no_file_gets_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for path, reason in (
        (tmp_path, "Is a directory"),
        (tmp_path / "file" / "below.csv", "Not a directory"),
        (tmp_path / ("long" * 100), "File name too long"),
        (tmp_path / "with\0NUL", "a path has no NUL"),
    ):
        for write in (write_text, append_text):
            with pytest.raises(OutputError, match=reason) as caught:
                write(path, "new")
            assert "\n" not in str(caught.value)
    for folder in (tmp_path / "file", Path("with\0NUL"), Path("-")):
        with pytest.raises(OutputError, match="cannot write"):
            make_folder(folder)


def test_a_dash_is_standard_output(
    tmp_path: Path, capfdbinary: pytest.CaptureFixture[bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with reserving_standard_output():
        print("a remark")
        write_text("-", "time,winch\n")
    read = capfdbinary.readouterr()
    assert read.out == b"time,winch\n"
    assert read.err == b"a remark\n"
    assert list(tmp_path.iterdir()) == []


def test_a_dash_in_a_notebook_takes_text_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    class Cell:
        text = ""

        def write(self, text):
            self.text += text

        def flush(self):
            pass

        def isatty(self):
            return False

    monkeypatch.setattr(sys, "stdout", Cell())
    write_text("-", "a\n")
    with pytest.raises(OutputError, match="takes text only"), replacing("-") as it:
        it.write_bytes(b"\x89PNG\xff")
    assert sys.stdout.text == "a\n"
    monkeypatch.setattr(sys, "stdout", None)
    with pytest.raises(OutputError, match="closed"):
        write_text("-", "a\n")


ALIAS = """
import sys
from flatrig.models.files import write_text
print("first", flush=True)
write_text(sys.argv[1], "second\\n")
"""


@pytest.mark.parametrize("name", ["/dev/stdout", "/dev/fd/1", "out.csv"])
def test_another_name_of_standard_output_is_written_behind_what_is_printed(
    name: str, tmp_path: Path
) -> None:
    if name.startswith("/dev") and not Path(name).exists():
        pytest.skip(f"no {name} here")
    with (tmp_path / "out.csv").open("w") as out:
        subprocess.run([sys.executable, "-c", ALIAS, name], cwd=tmp_path, stdout=out, check=True)
    assert (tmp_path / "out.csv").read_text() == "first\nsecond\n"


# A test in the background inherits that interruptions, and under nohup hang-ups, are ignored.
WRITER = """
import signal, sys, time
from flatrig.models.files import replacing
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)
with replacing("big.csv") as beside:
    beside.write_text("half")
    print("begun", flush=True)
    time.sleep(60)
"""


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGINT"])
def test_a_signal_leaves_nothing_half_written(name: str, tmp_path: Path) -> None:
    (tmp_path / "big.csv").write_text("old")
    number = getattr(signal, name)
    with subprocess.Popen(
        [sys.executable, "-c", WRITER], cwd=tmp_path, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    ) as running:  # fmt: skip
        try:
            assert running.stdout is not None
            assert running.stdout.readline() == b"begun\n"
            running.send_signal(number)
            status = running.wait(timeout=20)
        finally:
            running.kill()
    assert status in (128 + number, -number)
    assert [file.name for file in tmp_path.iterdir()] == ["big.csv"]
    assert (tmp_path / "big.csv").read_text() == "old"


def test_signals_are_left_to_who_has_asked_for_them() -> None:
    own = lambda *_: None  # noqa: E731
    before = signal.signal(signal.SIGTERM, own), signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with unwinding():
            assert signal.getsignal(signal.SIGTERM) is own
            assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGTERM, before[0])
        signal.signal(signal.SIGHUP, before[1])


def end_while_unwinding() -> None:
    with unwinding():
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(5)


def test_an_end_is_told_by_its_status() -> None:
    before = signal.signal(signal.SIGTERM, signal.SIG_DFL)
    try:
        with pytest.raises(Ended) as caught:
            end_while_unwinding()
        assert caught.value.code == 128 + signal.SIGTERM
        assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
    finally:
        signal.signal(signal.SIGTERM, before)
