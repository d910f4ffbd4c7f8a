import pytest

from fea.finger_path import PA_PER_N, FingerPath


def test_pressure_goes_up_and_down():
    path = FingerPath((2e3, 5e3), unload=True)
    assert path.targets == [2e3, 5e3, 8e3, 10e3]
    assert [path.pressure(t) for t in path.targets] == [2e3, 5e3, 2e3, 0.0]
    assert [path.branch(t) for t in path.targets] == ["loading", "loading", "unloading", "unloading"]
    assert [path.tip_load(t) for t in path.targets] == [0.0] * 4
    assert FingerPath((2e3, 5e3)).targets == [2e3, 5e3]
    part = FingerPath((2e3, 4e3, 6e3, 8e3), unload=True, unload_to_pa_gauge=4e3)
    assert [part.pressure(t) for t in part.targets] == [2e3, 4e3, 6e3, 8e3, 6e3, 4e3]
    between = FingerPath((2e3, 8e3), unload=True, unload_to_pa_gauge=4e3)
    assert [between.pressure(t) for t in between.targets] == [2e3, 8e3, 4e3]


def test_tip_is_loaded_at_the_last_pressure():
    path = FingerPath((2e3, 5e3), tip_loads_n=(0.01, 0.03))
    assert [path.pressure(t) for t in path.targets] == [2e3, 5e3, 5e3, 5e3]
    assert [path.tip_load(t) for t in path.targets] == pytest.approx([0.0, 0.0, 0.01, 0.03])
    assert [path.branch(t) for t in path.targets] == ["loading", "loading", "tip load", "tip load"]
    half = 0.5 * (path.targets[1] + path.targets[2])
    assert path.tip_load(half) == pytest.approx(0.5 * (half - 5e3) / (0.5 * PA_PER_N))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"pressures_pa_gauge": (5e3, 2e3)}, "pressures_pa_gauge"),
        ({"pressures_pa_gauge": (5e3,), "tip_loads_n": (0.2, 0.1)}, "loads_n"),
        ({"pressures_pa_gauge": (5e3,), "tip_loads_n": (0.1,), "unload": True}, "give one of them"),
        ({"pressures_pa_gauge": (5e3,), "unload": True, "unload_to_pa_gauge": 5e3}, "unload_to_pa_gauge = 5000"),
    ],
)
def test_bad_paths_are_refused(given, message):
    with pytest.raises(ValueError, match=message):
        FingerPath(**given)
