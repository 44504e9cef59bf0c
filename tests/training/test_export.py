"""`flatrig export`: files for a controller, and one line for what cannot be written."""

import shutil
import subprocess
from pathlib import Path

import pytest

from flatrig.training.cli import main


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_c_with_its_header_and_python_are_written(capsys):
    files = ["--c", "crane.c", "--python", "crane.py"]
    assert main(["export", "overhead", *files, "--set", "load_mass=80"]) == 0
    said = capsys.readouterr().out
    assert "wrote crane.c and crane.h" in said
    assert "wrote crane.py" in said
    assert Path("crane.h").read_text() in Path("crane.c").read_text()
    compile(Path("crane.py").read_text(), "crane.py", "exec")
    compiler = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    if compiler is None:
        pytest.skip("there is no C compiler")
    subprocess.run([compiler, "-std=c99", "-DSELF_TEST", "crane.c", "-lm"], check=True)
    assert subprocess.run(["./a.out"], check=False).returncode == 0


def test_c_goes_to_a_pipe(capsys):
    assert main(["export", "overhead", "--c", "-"]) == 0
    assert capsys.readouterr().out.startswith("/* overhead_crane.c: exact feedforward")
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["overhead"], "say what to write: --c FILE.c, --python FILE.py or --onnx FILE.onnx"),
        (["overhead", "--c", "crane.txt"], "--c is crane.txt, it must end in .c"),
        (["overhead", "--python", "crane"], "--python is crane, it must end in .py"),
        (["ball-in-corner", "--c", "hand.c"], "is a hand; --c and --python are for cranes only"),
        (["navy-2d", "--set", "pulley_mass=0", "--c", "n.c"], "as where a pulley without mass"),
    ],
)
def test_wrong_input_has_one_line_and_writes_nothing(arguments, line, capsys):
    assert main(["export", *arguments]) != 0
    said = capsys.readouterr().err
    assert line in said
    assert len(said.splitlines()) == 1
    assert list(Path().iterdir()) == []
