"""The viewer in headless Chromium; run by `make browser-check`, which sees to it that there is one."""

import shutil
import subprocess

import numpy as np
from live_view import live_view, wait_until
from PIL import Image

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
CHROMIUM = next((path for path in map(shutil.which, NAMES) if path), "chromium: none found, see .ci/browser_check")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--window-size=1200,700",
    "--virtual-time-budget=3000", "--enable-logging=stderr",
)  # fmt: skip


def browse(port, *flags, fragment=""):
    command = [CHROMIUM, *FLAGS, *flags, f"http://127.0.0.1:{port}/{fragment}"]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=300)
    # a script's error, or something that the page's policy forbids
    assert "CONSOLE" not in done.stderr, done.stderr
    return done.stdout


def screenshot(port, path, fragment=""):
    browse(port, f"--screenshot={path}", fragment=fragment)
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def test_sliders_move_the_fingers_and_the_page_shows_it(tmp_path):
    with live_view() as (hand, port):
        still = screenshot(port, tmp_path / "still.png")
        assert max(hand.state()["tip_angle_deg"]) < 15.0
        # the page moves its sliders there, as a person would, and sends what they show
        browse(port, fragment="#angles=0,90,0")
        wait_until(lambda: hand.state()["set_angle_deg"] == [0.0, 90.0, 0.0])
        wait_until(lambda: hand.state()["pressure_pa_gauge"][1] > 60e3)
        thumb, index, *others = hand.state()["tip_angle_deg"]
        assert index > 25.0
        assert max(thumb, *others) < 15.0
        closed = screenshot(port, tmp_path / "closed.png", "#angles=0,90,0")
    # the picture takes 640 x 480 of the page
    moved = (np.abs(closed - still)[:500, :660] > 20).any(axis=2)
    assert moved.sum() > 300
    # the index's line in the plot beside it
    assert (np.abs(closed[:, 660:] - (0xD5, 0x5E, 0x00)) < 40).all(axis=2).sum() > 30
