"""Success interval of a hand that is not known exactly."""

import numpy as np
import pytest
from scipy.stats import beta

from softhand_sim.uncertainty import success_band, success_interval


def jeffreys(held, trials):
    return beta.ppf(0.025, held + 0.5, trials - held + 0.5), beta.ppf(0.975, held + 0.5, trials - held + 0.5)


@pytest.mark.parametrize("fingers", [1, 7])
def test_fingers_that_do_alike_give_the_plain_interval(fingers):
    assert success_interval([13] * fingers, 20) == pytest.approx(jeffreys(13, 20), abs=1e-9)


def test_all_or_none_held_reaches_to_the_end():
    assert success_interval([5, 5], 5) == (pytest.approx(jeffreys(5, 5)[0]), 1.0)
    assert success_interval([0], 5) == (0.0, pytest.approx(jeffreys(0, 5)[1]))


def test_the_interval_is_that_of_draws_from_the_mixture():
    rng, held, trials = np.random.default_rng(0), (3, 9, 17), 20
    drawn = np.concatenate([rng.beta(h + 0.5, trials - h + 0.5, 200_000) for h in held])
    assert success_interval(held, trials) == pytest.approx(np.percentile(drawn, [2.5, 97.5]), abs=2e-3)


def test_the_interval_grows_with_the_spread_of_the_fingers():
    widths = [np.diff(success_interval([10 - k, 10 + k], 20))[0] for k in range(8)]
    assert (np.diff(widths) > 0.0).all()
    # and holds what the fingers have in common at any spread
    assert all(low < 0.5 < high for low, high in (success_interval([10 - k, 10 + k], 20) for k in range(8)))


def places(values, other):
    return [{"wall": float(x), "mesh": float(y)} for x, y in zip(values, other, strict=True)]


def test_a_rate_that_follows_one_source_is_that_source_s():
    x = np.linspace(-1.0, 1.0, 9)
    y = np.array([0.3, -0.9, 0.7, -0.1, 0.0, 0.1, -0.7, 0.9, -0.3])
    band = success_band([int(10 + 8 * v) for v in x], 20, places(x, y))
    assert sum(band.shares.values()) == pytest.approx(1.0)
    assert band.shares["wall"] > 0.8
    assert band.shares["mesh"] < 1e-3
    assert band.shares["rest"] < 1e-3
    assert (band.held, band.trials, band.rate) == (90, 180, 0.5)
    # law of total variance: trials are the mean of the posteriors' own
    a = np.array([10 + 8 * v for v in x]) + 0.5
    own = beta.var(a, 21.0 - a)
    total = own.mean() + beta.mean(a, 21.0 - a).var()
    assert band.shares["trials"] == pytest.approx(own.mean() / total)


def test_no_spread_is_all_trials():
    shares = success_band([4, 4, 4], 5, places([0.0] * 3, [0.0] * 3)).shares
    assert dict(shares) == {"trials": 1.0, "rest": 0.0}


def test_too_few_fingers_are_not_shared_out():
    shares = success_band([1, 4, 2], 5, places([-1.0, 0.0, 1.0], [0.5, -0.5, 0.0])).shares
    assert set(shares) == {"trials", "rest"}
    assert shares["rest"] > 0.1


@pytest.mark.parametrize(
    ("held", "trials", "told"),
    [
        ([], 5, "held: 0 fingers of 5 trials: must be 1 or more of each"),
        ([1], 0, "held: 1 fingers of 0 trials"),
        ([1, 6], 5, r"held\[1\] = 6: must lie in \[0, 5\]"),
        ([-1], 5, r"held\[0\] = -1"),
    ],
)
def test_bad_counts_are_named(held, trials, told):
    with pytest.raises(ValueError, match=told):
        success_interval(held, trials)


def test_a_finger_without_a_place_is_named():
    with pytest.raises(ValueError, match="coordinates: 1 given for 2 fingers"):
        success_band([1, 2], 5, [{}])
