"""Solved fingers by content: every field changes the key, a kept result is not solved again, damage is refused."""

import json
import os
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

from fea.calibration import Materials
from fea.checkpoint import content_hash
from fea.density import DENSITIES
from fea.geometry import FingerGeometry
from fea.identity import PACKAGES, finger_identity
from fea.laws import IsochoricOgden
from fea.store import DamagedEntryError, FingerStore, Solved

SOLVED = Solved(artifact={"curve": [0.1, 95.0]}, report={"wall_s": 3.0})
COARSE = DENSITIES["coarse"]


def changed(value):
    """A value of the same kind that differs as little as a user's change may."""
    if isinstance(value, int):
        return value + 1
    if isinstance(value, float):
        return float(np.nextafter(value, np.inf))
    if isinstance(value, str):
        return value + "x"
    if isinstance(value, tuple):
        return (changed(value[0]), *value[1:])
    if is_dataclass(value):
        first = fields(value)[0].name
        return replace(value, **{first: changed(getattr(value, first))})
    return {**value, "more": 1.0}


def variants(item):
    for field in fields(item):
        yield field.name, replace(item, **{field.name: changed(getattr(item, field.name))})


def test_every_single_field_changes_the_key(geometry, materials):
    keys = {"as it is": content_hash(finger_identity(geometry, materials, COARSE))}
    for name, other in variants(geometry):
        keys[f"geometry.{name}"] = content_hash(finger_identity(other, materials, COARSE))
    for role in ("silicone", "tpu", "pet"):
        for name, other in variants(getattr(materials, role)):
            keys[f"{role}.{name}"] = content_hash(
                finger_identity(geometry, replace(materials, **{role: other}), COARSE)
            )
        for name, law in variants(getattr(materials, role).law):
            other = replace(getattr(materials, role), law=law)
            keys[f"{role}.law.{name}"] = content_hash(
                finger_identity(geometry, replace(materials, **{role: other}), COARSE)
            )
    for name, density in variants(COARSE):
        if name != "name":
            keys[f"density.{name}"] = content_hash(finger_identity(geometry, materials, density))
    for part in ("actuator", "exoskeleton"):
        for name, mesh in variants(getattr(COARSE, part)):
            keys[f"{part}.{name}"] = content_hash(finger_identity(geometry, materials, replace(COARSE, **{part: mesh})))
    keys["density"] = content_hash(finger_identity(geometry, materials, DENSITIES["calibration"]))
    keys["choose"] = content_hash(finger_identity(geometry, materials, COARSE, choose_sector=True))
    # a field's first entry stands for it in one more way
    same = {"actuator.theta_cells": "density.actuator", "exoskeleton.sector_cells": "density.exoskeleton"}
    same |= {f"{role}.law.{fields(m.law)[0].name}": f"{role}.law" for role, m in vars(materials).items()}
    for one, other in same.items():
        assert keys.pop(one) == keys[other]
    assert len(set(keys.values())) == len(keys)
    assert len(keys) > 50


def test_equal_fingers_have_equal_keys_whatever_made_them(geometry, materials):
    again = Materials(
        **{role: replace(m, parameters=dict(reversed(m.parameters.items()))) for role, m in vars(materials).items()}
    )
    one = finger_identity(geometry, materials, COARSE)
    assert content_hash(one) == content_hash(finger_identity(FingerGeometry(), again, COARSE))
    assert content_hash(one) == content_hash(json.loads(json.dumps(one)))


def test_identity_names_code_and_versions(geometry, materials):
    identity = finger_identity(geometry, materials, COARSE)
    assert len(identity["code"]["fea_sha256"]) == 64
    assert set(identity["versions"]) == set(PACKAGES)
    assert identity["versions"]["numpy"] == np.__version__
    law = identity["materials"]["silicone"]["law"]
    assert law["type"] == IsochoricOgden.__name__
    assert law["bulk_modulus_pa"] == materials.silicone.law.bulk_modulus_pa


@pytest.fixture
def warnings():
    return []


@pytest.fixture
def store(tmp_path, warnings):
    return FingerStore(tmp_path / "store", warn=warnings.append)


class Work:
    """Analyses that count how often they run."""

    def __init__(self, error=None):
        self.runs, self.error = 0, error

    def __call__(self):
        self.runs += 1
        if self.error is not None:
            raise self.error
        return SOLVED


def test_an_unchanged_finger_is_solved_once_and_a_changed_one_anew(store, warnings):
    work = Work()
    assert store.solve({"wall_m": 2e-3}, work) == (SOLVED, False)
    assert store.solve({"wall_m": 2e-3}, work) == (SOLVED, True)
    assert work.runs == 1
    assert store.solve({"wall_m": float(np.nextafter(2e-3, 1.0))}, work) == (SOLVED, False)
    assert work.runs == 2
    assert store.solve({"wall_m": 2e-3}, work, force=True) == (SOLVED, False)
    assert work.runs == 3
    assert warnings == []


def test_a_refused_finger_is_kept_with_its_reason(store):
    work = Work(ValueError("finger.pressure_pa_gauge: 3 usable converged states"))
    for _ in range(2):
        with pytest.raises(ValueError, match="3 usable converged states"):
            store.solve({"wall_m": 2e-3}, work)
    assert work.runs == 1


def test_what_is_no_verdict_on_the_finger_is_not_kept(store):
    for error in (KeyboardInterrupt(), MemoryError(), OSError("disk")):
        with pytest.raises(type(error)):
            store.solve({"wall_m": 2e-3}, Work(error))
    assert store.read({"wall_m": 2e-3}) is None


@pytest.mark.parametrize(
    ("damage", "told"),
    [
        (lambda text: text[: len(text) // 2], "not a whole JSON file"),
        (lambda _: "", "not a whole JSON file"),
        (lambda text: text.replace("95.0", "96.0"), "sha256 is not that of identity and outcome"),
        (lambda text: text.replace('"wall_m": 0.002', '"wall_m": 0.003'), "sha256 is not that of identity and outcome"),
        (lambda text: text.replace("95.0", "NaN"), "sha256 is not that of identity and outcome"),
        (lambda text: text.replace('"format_version": 1', '"format_version": 9'), "format_version = 9 must be 1"),
        (lambda text: text.replace("solved-finger", "hand"), "format is not"),
        (lambda _: "[1]", "format is not"),
    ],
)
def test_a_damaged_file_is_refused_by_name_and_solved_again(store, warnings, damage, told):
    identity, work = {"wall_m": 2e-3}, Work()
    store.solve(identity, work)
    file = store.file(identity)
    text = file.read_text()
    assert damage(text) != text
    file.write_text(damage(text))
    with pytest.raises(DamagedEntryError, match=told):
        store.read(identity)
    assert store.solve(identity, work) == (SOLVED, False)
    assert work.runs == 2
    assert len(warnings) == 1
    assert str(file) in warnings[0]
    assert told in warnings[0]
    assert file.read_text() == text


def test_a_file_under_another_finger_s_name_is_refused(store, warnings):
    work = Work()
    store.solve({"wall_m": 2e-3}, work)
    os.link(store.file({"wall_m": 2e-3}), store.file({"wall_m": 3e-3}))
    assert store.solve({"wall_m": 3e-3}, work) == (SOLVED, False)
    assert "identity is another finger's" in warnings[0]


def test_a_folder_that_cannot_be_written_costs_no_result(tmp_path, warnings):
    (tmp_path / "file").write_text("")
    store = FingerStore(tmp_path / "file" / "store", warn=warnings.append)
    assert store.file({}).name == f"{content_hash({})}.json"
    assert FingerStore(tmp_path / "file", warn=warnings.append).solve({}, Work()) == (SOLVED, False)
    assert "not kept in the store" in warnings[-1]


def test_nothing_half_written_is_left(store):
    store.solve({"wall_m": 2e-3}, Work())
    assert [p.name for p in store.file({}).parent.iterdir()] == [store.file({"wall_m": 2e-3}).name]
