"""The report in headless Chromium; run by `make browser-check`, which sees to it that there is one."""

import re
import shutil
import subprocess

import numpy as np
import pytest
from PIL import Image
from tests_report_helpers import COLOUR, content

from softhand_sim.benchmark.html_report import html_report

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
CHROMIUM = next((path for path in map(shutil.which, NAMES) if path), "chromium: none found, see .ci/browser_check")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--window-size=1250,2000",
    "--virtual-time-budget=5000", "--host-resolver-rules=MAP * ~NOTFOUND", "--enable-logging=stderr",
)  # fmt: skip


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(html_report(content()), encoding="utf-8")
    return path


def browse(report, *flags, fragment=""):
    command = [CHROMIUM, *FLAGS, *flags, f"{report.as_uri()}{fragment}"]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=300)
    # a script's error, or something that the page's policy forbids
    assert "CONSOLE" not in done.stderr, done.stderr
    return done.stdout


def order(page):
    return re.findall(r"<tr><td data-value=\"(\w+)\">", page)


@pytest.mark.parametrize(
    ("fragment", "expected"),
    [
        ("", ["mug", "apple", "soup_can"]),
        ("#sort=object", ["apple", "mug", "soup_can"]),
        ("#sort=rate", ["soup_can", "mug", "apple"]),
        ("#sort=rate,descending", ["apple", "mug", "soup_can"]),
        # numbers, not words: 68, 118, 349; and what is missing comes last either way
        ("#sort=mass%20g", ["apple", "mug", "soup_can"]),
        ("#sort=slip%20mm", ["mug", "apple", "soup_can"]),
        ("#sort=slip%20mm,descending", ["apple", "mug", "soup_can"]),
    ],
)
def test_the_table_sorts(report, fragment, expected):
    page = browse(report, "--dump-dom", fragment=fragment)
    assert order(page) == expected
    assert page.count('aria-sort="') == (1 if fragment else 0)


def test_a_click_sorts(report, tmp_path):
    clicking = report.read_text(encoding="utf-8").replace(
        "</script>", 'heads[0].querySelector("button").click(); heads[0].querySelector("button").click();</script>'
    )
    (tmp_path / "clicked.html").write_text(clicking, encoding="utf-8")
    page = browse(tmp_path / "clicked.html", "--dump-dom")
    assert order(page) == ["soup_can", "mug", "apple"]


def test_pictures_and_plots_are_drawn(report, tmp_path):
    browse(report, f"--screenshot={tmp_path / 'page.png'}")
    pixels = np.asarray(Image.open(tmp_path / "page.png").convert("RGB")).astype(int)
    # three pictures of 320 x 240; the films are folded in
    alike = (np.abs(pixels - COLOUR) < 12).all(axis=2).sum()
    assert 0.9 < alike / (3 * 320 * 240) < 1.05
    # the bars of the histograms
    assert (np.abs(pixels - (0x00, 0x72, 0xB2)) < 12).all(axis=2).sum() > 500
