"""`flatrig report`: a page that holds what the package finds, and nothing from elsewhere."""

import base64
import io
import re
from html import unescape
from pathlib import Path

import pytest
from PIL import Image

from flatrig import feedforward, models
from flatrig.envs import Scenario
from flatrig.training.cli import main
from flatrig.training.compare.chosen import chosen
from flatrig.training.film.filming import Look
from flatrig.training.report import report_cranes
from flatrig.training.report.page import page, paragraph, table
from flatrig.training.simulate.one_episode import simulate


def test_the_page_holds_what_is_found(tmp_path: Path) -> None:
    file = tmp_path / "rotary.html"
    assert main(["report", "rotary", "--plain", "--controller", "lqr", "-o", str(file)]) == 0
    text = unescape(file.read_text())
    rig = models.make("rotary")
    move = models.default_move(rig)
    found = feedforward.check(rig, feedforward.from_move(move))
    for size in found.sizing:
        assert f"<td>{size.drive} [{size.unit}]</td><td>{size.largest:.4g}</td>" in text
    episode = simulate(rig, move, chosen("lqr", "crane", rig)[0], Scenario(load_mass=1.2))
    assert f"<td>LQR, sway</td><td>{1e3 * (episode.distances**2).mean() ** 0.5:.4g}</td>" in text
    assert "The plant: load_mass 1.2." in text
    described = re.search("<pre>(.*)</pre>", text, flags=re.DOTALL)
    assert described
    assert models.loads(described[1]) == (rig, move)


def test_the_page_needs_no_network(tmp_path: Path) -> None:
    assert main(["report", "overhead", "--plain", "-o", str(tmp_path)]) == 0
    text = (tmp_path / "overhead_crane.html").read_text()
    assert set(re.findall(r'(?:src|href)="([^:]+):', text)) == {"data"}
    assert text.count('src="data:image/png;base64,iVBOR') == 2  # the move, and the episode


def test_a_move_that_cannot_be_made_is_reported_as_such(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    words = ["report", "navy-2d", "--move", "printed", "--plain", "-o", str(tmp_path / "a.html")]
    assert main(words) == 1
    assert "rope tagline would have to push" in capsys.readouterr().err
    text = (tmp_path / "a.html").read_text()
    assert "rope tagline would have to push" in text
    assert "In MuJoCo" not in text


def test_texts_are_no_tags() -> None:
    made = page("a < b", [paragraph("<script>"), table(("a&b",), [("<td>",)])])
    assert "<script>" not in made
    assert "<title>a &lt; b</title>" in made
    assert "<th>a&amp;b</th>" in made
    assert "<td>&lt;td&gt;</td>" in made


def test_wrong_words_get_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    for words, message in (
        (["overhead", "--controller", "pdd"], "did you mean"),
        (["overhead", "--scenario", "lode_mass=1"], "did you mean load_mass"),
        (["two-finger"], "this command is for cranes only"),
    ):
        assert main(["report", *words]) == 2
        said = capsys.readouterr().err
        assert message in said
        assert said.count("\n") == 1


def test_a_film_travels_inside(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name, fps in (("STILL", 1.0), ("FILM", 2.0)):
        monkeypatch.setattr(report_cranes, name, Look(width=96, height=72, fps=fps))
    file = tmp_path / "overhead.html"
    assert main(["report", "overhead", "-o", str(file)]) == 0
    coded = re.findall(r"data:image/gif;base64,([^\"]+)", file.read_text())
    with Image.open(io.BytesIO(base64.b64decode(coded[0]))) as film:
        assert film.n_frames == 13  # 3 s of move and 3 s after it, two pictures a second


def test_without_opengl_it_is_refused_before_anything_is_simulated(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def none() -> str:
        raise models.ModelError("no OpenGL here")

    monkeypatch.setattr(report_cranes.render, "backend", none)
    monkeypatch.setattr(report_cranes, "simulate", None)
    assert main(["report", "overhead"]) == 2
    assert capsys.readouterr().err == "flatrig: error: no OpenGL here\n"
