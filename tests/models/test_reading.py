"""What cannot be read, or is no description, gets one line that says what would be right."""

import os
from pathlib import Path

import pytest

from flatrig import models
from flatrig.feedforward import from_csv
from flatrig.models.errors import FlatrigError, OptionError, PathError, RigError
from flatrig.models.reading import read_json, read_text

SHORT = 'rig = "overhead_crane"\nload_mass = 80.0\n'
OVERHEAD = models.overhead_crane(load_mass=80.0)


def test_text_comes_without_its_mark_and_with_newlines(tmp_path: Path) -> None:
    path = tmp_path / "text"
    path.write_bytes(b"\xef\xbb\xbfa\r\nb\rc\n")
    assert read_text(path, OptionError) == "a\nb\nc\n"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("a".encode("utf-16"), "it is in UTF-16, save it in UTF-8"),
        ("häuser".encode("latin-1"), "byte 0xe4 at 1 is not UTF-8"),
        (bytes(200), ""),
        (b"#" * 2000, "larger than"),
    ],
)
def test_what_is_no_text_is_refused(content: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "text"
    path.write_bytes(content)
    if message:
        with pytest.raises(OptionError, match=message):
            read_text(path, OptionError, largest=1000)
    else:
        assert read_text(path, OptionError, largest=1000) == "\0" * 200


def test_what_is_no_file_is_refused(tmp_path: Path) -> None:
    endless = tmp_path / "endless"
    endless.symlink_to("/dev/zero")
    paths = [tmp_path, tmp_path / "nowhere", tmp_path / "a\0b", tmp_path / ("x" * 300)]
    for path in [*paths, *([endless] if os.path.exists("/dev/zero") else [])]:
        for read in (read_text, read_json):
            with pytest.raises(RigError, match="cannot read") as caught:
                read(path, RigError)
            assert "\n" not in str(caught.value)
        for load in (models.load, models.load_move, from_csv):
            with pytest.raises(FlatrigError, match="cannot read"):
                load(path)


@pytest.mark.parametrize("text", ["[" * 100_000, '{"a": ' * 100_000, "9" * 5000, "", "{", "nul"])
def test_json_that_is_none_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "card.json"
    path.write_text(text)
    with pytest.raises(OptionError, match=r"cannot read .*card\.json: not JSON"):
        read_json(path, OptionError)


@pytest.mark.parametrize(
    "change",
    [lambda text: b"\xef\xbb\xbf" + text, lambda text: text.replace(b"\n", b"\r\n")],
    ids=["byte-order mark", "CRLF"],
)
def test_a_description_may_come_from_another_system(change, tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_bytes(change(SHORT.encode()))
    assert models.load(path)[0] == OVERHEAD


WRONG = {
    'rig = "overhead_crane"\nname = "x"': "'name' cannot stand beside rig = 'overhead_crane'",
    SHORT + '[[loads]]\nname = "x"\nmass = 3': "'loads' cannot stand beside rig",
    SHORT + "duration = 3.0": "the entry 'duration' belongs to the move, below a line",
    "duration = 3.0": "the entry 'duration' belongs to the move, below a line",
    'Rig = "overhead"': "unknown entry 'Rig'; did you mean rig",
    "rig = 3": "rig is 3, it must be a name",
    'rig = ["overhead"]': r"rig is \['overhead'\], it must be a name",
    "a = " + "[" * 5000 + "]" * 5000: "not TOML of a rig: it is nested too deeply",
    'rig = "overhead"\nload_mass' + ".a" * 5000 + " = 1": "load_mass is a deeply nested dict",
    'rig = "overhead"\nload_mass = ' + "9" * 5000: "a number has thousands of digits",
    'rig = "overhead"\nload_mass = 2020-01-01': "it must be a number",
    'rig = "overhead"\nload_mass = inf': "it must be finite",
    'rig = "over\\u0000head"': "did you mean overhead_crane",
    SHORT + '[move]\nprofile = "sampled"\nsamples = "a\\u0000b.csv"': "a path has no NUL",
}


def read_whole(text: str) -> None:
    """A description with the samples that its move may name."""
    move = models.loads(text)[1]
    assert move is not None
    from_csv(move.samples)


@pytest.mark.parametrize("text", WRONG, ids=range(len(WRONG)))
def test_a_slip_in_a_description_is_one_line(text: str) -> None:
    with pytest.raises(FlatrigError, match=WRONG[text]) as caught:
        read_whole(text)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize("mark", [";", "\t", " "])
def test_columns_parted_by_something_else_are_named(mark: str, tmp_path: Path) -> None:
    path = tmp_path / "path.csv"
    path.write_text("\n".join(f"{i}{mark}{i * i}" for i in range(5)))
    with pytest.raises(PathError, match=r"parted by commas, not by (semicolons|tabs|spaces)"):
        from_csv(path)
