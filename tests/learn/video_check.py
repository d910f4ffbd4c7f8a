"""Gymnasium's `RecordVideo` films an episode without a screen (moviepy, of the extra `learn`)."""

import gymnasium
import numpy as np
from gymnasium.wrappers import RecordVideo
from moviepy import VideoFileClip

import envs

STEPS = 12


def test_a_film_shows_the_hand_closing(tmp_path, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    env = gymnasium.make(envs.GRASP_ENV_ID, render_mode="rgb_array", max_episode_steps=STEPS)
    env = RecordVideo(env, str(tmp_path / "films"), episode_trigger=lambda _: True)
    env.reset(seed=0)
    action = np.array([1, 1, 1, 0, 0, -1, 0, 0, 0], dtype=np.float32)
    for _ in range(STEPS):
        env.step(action)
    env.close()
    film = VideoFileClip(str(tmp_path / "films" / "rl-video-episode-0.mp4"))
    assert tuple(film.size) == (640, 480)
    # 40 ms a step
    assert film.fps == 25
    first, last = (film.get_frame(t).astype(float) for t in (0.0, film.duration - 0.05))
    film.close()
    assert first.std() > 10.0
    assert np.abs(last - first).max() > 50.0
