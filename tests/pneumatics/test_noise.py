"""Draws that depend on seed and number alone."""

import pickle

import numpy as np

from softhand_sim.pneumatics.noise import NumberedNoise


def test_draws_are_those_of_a_fresh_generator_in_any_order():
    rng, noise = np.random.default_rng(0), NumberedNoise()
    for _ in range(200):
        seed, number, count = int(rng.integers(2**53)), int(rng.integers(10_000)), int(rng.integers(1, 9))
        fresh = np.random.Generator(np.random.Philox(key=seed, counter=number << 64))
        assert noise.draw(seed, number, count) == fresh.standard_normal(count).tolist()


def test_a_copy_draws_the_same():
    noise = NumberedNoise()
    noise.draw(5, 6, 7)
    assert pickle.loads(pickle.dumps(noise)).draw(1, 2, 3) == noise.draw(1, 2, 3)
