"""Analyses (i) and (ii) in a process of their own, beside (iii): the same result, and where it ends up."""

from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context

import numpy as np
import pytest

from fea import calibration
from fea.density import DENSITIES


def test_the_parts_alone_do_not_depend_on_the_process(geometry, materials):
    small = replace(geometry, ring_count=3)
    density = replace(DENSITIES["coarse"], pressures_pa_gauge=(2e3, 4e3))
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        there = [
            pool.submit(work, small, materials, density)
            for work in (calibration.run_actuator, calibration.run_exoskeleton)
        ]
        here = [work(small, materials, density) for work in (calibration.run_actuator, calibration.run_exoskeleton)]
        for one, other in zip(there, here, strict=True):
            (result, mass), (own, own_mass) = one.result(), other
            assert mass == own_mass
            for name, value in vars(own).items():
                if isinstance(value, np.ndarray):
                    np.testing.assert_allclose(getattr(result, name), value, rtol=1e-9, atol=1e-15)
            assert result.status is own.status


def test_each_part_goes_to_its_place_and_every_step_is_told(monkeypatch, geometry, materials):
    class Parts:
        pressure_pa_gauge, load_n = np.zeros(10), np.zeros(6)

    class Here:
        """A pool that only writes down what it is given."""

        def __init__(self):
            self.given = []

        def submit(self, work, *arguments):
            self.given.append(work)
            done = Future()
            done.set_result(work(*arguments))
            return done

    parts, pool, steps = Parts(), Here(), []
    monkeypatch.setattr(calibration, "run_actuator", lambda *_: (parts, 0.007))
    monkeypatch.setattr(calibration, "run_exoskeleton", lambda *_: (parts, 0.005))
    monkeypatch.setattr(calibration, "run_finger", lambda *_: "iii")
    monkeypatch.setattr(calibration, "reduce_finger", lambda *given: given)
    arguments = (geometry, materials, DENSITIES["coarse"])
    beside = calibration.calibrate(*arguments, progress=lambda: steps.append(1), beside=pool)
    alone = calibration.calibrate(*arguments)
    assert pool.given == [calibration.run_actuator, calibration.run_exoskeleton]
    assert len(steps) == 9 + 6
    assert beside.fit == alone.fit == (parts, parts, "iii")
    assert beside.mass_kg == alone.mass_kg == pytest.approx(0.012)
