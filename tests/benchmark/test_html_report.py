"""The report as a file: what a browser would be given. In a browser: `chromium_check.py`, by `make browser-check`."""

import base64
import dataclasses
import io
import json
import re
from html.parser import HTMLParser
from xml.etree import ElementTree

import pytest
from PIL import Image
from tests_report_helpers import HELD, TRIALS, content, results, sweep

from scripts import grasp_benchmark
from softhand_sim.benchmark.films import film_all
from softhand_sim.benchmark.histogram import histogram
from softhand_sim.benchmark.html_report import html_report
from softhand_sim.benchmark.pictures import shown_trial
from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.catalogue import make_object

VOID = {"meta", "img", "line", "circle", "rect"}


class Page(HTMLParser):
    """Elements with their attributes and texts; checks that each is closed where it should be."""

    def __init__(self, text):
        super().__init__()
        self.open, self.found, self.cells = [], [], []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))
        if tag == "tr":
            self.cells.append([])
        if tag in ("td", "th"):
            self.cells[-1].append([dict(attrs).get("data-value"), ""])
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        if any(tag in self.open for tag in ("td", "th")):
            self.cells[-1][-1][1] += data


def test_the_table_has_a_row_an_object_with_values_that_sort():
    page = Page(html_report(content()))
    head, *rows = page.cells
    names = [text for _, text in head]
    assert [row[0][1] for row in rows] == list(HELD)
    for row, held in zip(rows, HELD.values(), strict=True):
        cell = dict(zip(names, row, strict=True))
        assert cell["rate"] == [str(held / TRIALS), f"{held / TRIALS:.2f}"]
        assert cell["95 % Wilson"][1].count(" - ") == 1
        assert (cell["slip mm"] == ["", "-"]) == (held == 0)
    # held with slips of 0 to 3 mm
    assert float(dict(zip(names, rows[1], strict=True))["slip mm"][0]) == pytest.approx(1.5e-3)


def test_nothing_comes_from_outside_and_nothing_is_taken_for_markup():
    text = html_report(content())
    for tag, attributes in Page(text).found:
        assert tag not in ("link", "iframe", "object", "embed", "base")
        for key in ("src", "href", "srcset", "data", "action", "poster"):
            assert attributes.get(key, "data:").startswith("data:")
    assert "url(" not in text
    assert "@import" not in text
    assert "default-src 'none'" in text
    assert "<b>wrench</b>" not in text
    assert "&lt;b&gt;wrench&lt;/b&gt;: no mass &amp; no mesh" in text


def test_pictures_and_films_are_whole_and_films_move():
    images = [attributes for tag, attributes in Page(html_report(content())).found if tag == "img"]
    frames = []
    for image in images:
        kind, data = image["src"].split(",", 1)
        assert kind == "data:image/webp;base64"
        frames.append(Image.open(io.BytesIO(base64.b64decode(data, validate=True))).n_frames)
    assert frames == [1, 3] * len(HELD)
    assert images[0]["alt"] == "mug, seed 0: HELD"
    without = html_report(content(films=(), no_films="no OpenGL library"))
    assert "no OpenGL library" in without


def test_a_trial_that_killed_its_process_is_not_run_again_for_a_picture():
    found = results()
    assert shown_trial(found, "apple").outcome is Outcome.HELD
    dead = [dataclasses.replace(r, outcome=Outcome.CRASHED) for r in found]
    assert shown_trial([*dead[:3], *found[3:4]], "mug").seed == 3
    plan = BenchmarkPlan(objects=(make_object("mug"),), trials=TRIALS)
    assert list(film_all(plan, dead)) == []


def test_everything_of_the_run_is_there():
    text = html_report(content())
    for wanted in ("1 of 12 verdicts differ", "holes filled", "3.17.0", "GasDynamics()", "apple along mass (g): falls"):
        assert wanted in text
    drawings = re.findall(r"<svg.*?</svg>", text, flags=re.DOTALL)
    assert len(drawings) == 4
    for drawing in drawings:
        ElementTree.fromstring(drawing)
    nothing_held = [r for r in results() if r.object == "soup_can"]
    assert "no object was in the hand" in html_report(content(results=nothing_held, films=(), sweeps=()))


@pytest.mark.parametrize("log", [False, True])
def test_a_histogram_counts_every_value_once(log):
    values = [0.0, 0.001, 0.5, 3.0, 9.9, 12.0]
    drawing = ElementTree.fromstring(histogram("slip", "mm", values, 10.0, log=log))
    bars = [float(rect.get("height")) for rect in drawing.iter("{http://www.w3.org/2000/svg}rect")]
    unit = min(bar for bar in bars if bar > 0.0)
    assert sum(bars) / unit == pytest.approx(len(values), rel=0.01)


def test_the_command_line_writes_a_report_with_its_sweeps(tmp_path, capsys):
    protocol = tmp_path / "quick.toml"
    protocol.write_text(
        'source = "test"\napproach_m = 0.05\nclose_s = 0.2\nsettle_s = 0.05\n'
        '[[phase]]\ndo = "lift"\nheight_m = 0.03\n[[phase]]\ndo = "hold"\nduration_s = 0.1\n',
        encoding="utf-8",
    )
    (tmp_path / "sweep.json").write_text(json.dumps(sweep()))
    (tmp_path / "other.json").write_text('{"settings": {}, "rows": []}')
    report = tmp_path / "report.html"
    line = ["--objects", "golf_ball", "--trials", "1", "--no-pictures", "--protocol", str(protocol)]

    def told(*more):
        assert grasp_benchmark.main([*line, *more]) == 2
        return capsys.readouterr().err

    assert "needs --report" in told("--sweeps", str(tmp_path / "sweep.json"))
    assert "not a file of grasp_sweep.py" in told("--report", str(report), "--sweeps", str(tmp_path / "other.json"))
    assert "no file at" in told("--report", str(report), "--sweeps", str(tmp_path / "nowhere.json"))
    assert not report.exists()
    assert grasp_benchmark.main([*line, "--report", str(report), "--sweeps", str(tmp_path / "sweep.json")]) == 0
    text = report.read_text(encoding="utf-8")
    page = Page(text)
    assert page.cells[1][0][1] == "golf_ball"
    assert "calibration_sha256" in text
    assert "apple along mass (g): falls" in text
    films = [attributes["src"] for tag, attributes in page.found if tag == "img"]
    # without a library that draws, the page says so
    assert len(films) == 2 or "no OpenGL library" in text
    if films:
        assert Image.open(io.BytesIO(base64.b64decode(films[1].split(",")[1]))).n_frames > 3
