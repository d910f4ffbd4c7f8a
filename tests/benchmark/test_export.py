"""Trials as Parquet: every field, its type, and the conditions come back."""

import dataclasses
import json
import sqlite3

import pyarrow.parquet
import pytest

from scripts import export_trials
from softhand_sim.benchmark.plan import BenchmarkPlan
from softhand_sim.benchmark.report import trial_rows
from softhand_sim.benchmark.store import TrialStore, conditions
from softhand_sim.grasp.result import TrialResult, crashed
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.catalogue import make_object

PLAN = BenchmarkPlan(objects=(make_object("apple"), make_object("mug")), trials=2)


@pytest.fixture
def store(tmp_path):
    path = tmp_path / "run.sqlite"
    with TrialStore(path, PLAN) as kept:
        for model in PLAN.objects:
            for seed in (1, 0):
                blank = crashed(model, PLAN.protocol, seed)
                kept.add(
                    dataclasses.replace(
                        blank,
                        outcome=Outcome.HELD,
                        slip_m=1e-3 * (seed + 1),
                        links=("thumb_tip", "palm"),
                        force_n={**blank.force_n, "palm": 0.5},
                        engine_warnings={"mjWARN_BADQACC": 2},
                        object_offset_m=(0.01, -0.02),
                    )
                )
    return path


def test_every_field_of_every_trial_comes_back(store, tmp_path, capsys):
    out, text = tmp_path / "run.parquet", tmp_path / "run.json"
    assert export_trials.main([str(store), "--out", str(out), "--json", str(text)]) == 0
    assert "4 trials of 2 objects" in capsys.readouterr().out
    table = pyarrow.parquet.read_table(out)
    assert [(row["object"], row["seed"]) for row in table.to_pylist()] == [
        ("apple", 0), ("apple", 1), ("mug", 0), ("mug", 1),
    ]  # fmt: skip
    names = {field.name for field in dataclasses.fields(TrialResult)} - {"object_offset_m"}
    assert set(table.column_names) == names | {"object_offset_x_m", "object_offset_y_m"}
    row = table.to_pylist()[1]
    assert row["outcome"] == "HELD"
    assert row["slip_m"] == 2e-3
    assert row["force_n"]["palm"] == 0.5
    assert row["links"] == ["thumb_tip", "palm"]
    assert dict(row["engine_warnings"]) == {"mjWARN_BADQACC": 2}
    assert (row["object_offset_x_m"], row["object_offset_y_m"]) == (0.01, -0.02)
    assert json.loads(table.schema.metadata[b"softhand_sim_conditions"]) == conditions(PLAN)
    assert [path.name for path in tmp_path.iterdir() if "partial" in path.name] == []
    with TrialStore(store, PLAN) as kept:
        rows = trial_rows(sorted(kept.results(), key=lambda result: (result.object, result.seed)))
    assert json.loads(text.read_text())["trials"] == json.loads(json.dumps(rows))


def test_what_is_no_store_is_refused(tmp_path, store, capsys, monkeypatch):
    def told(*argv):
        assert export_trials.main([str(item) for item in argv]) == 2
        return capsys.readouterr().err

    out = tmp_path / "x.parquet"
    assert "no store at" in told(tmp_path / "nowhere.sqlite", "--out", out)
    (tmp_path / "letter").write_text("Dear sir or madam, " * 100)
    assert "not a store" in told(tmp_path / "letter", "--out", out)
    sqlite3.connect(tmp_path / "empty").execute("CREATE TABLE a (b)")
    assert "not a store" in told(tmp_path / "empty", "--out", out)
    assert "--out or --json" in told(store)
    monkeypatch.setattr("softhand_sim.benchmark.parquet.find_spec", lambda _name: None)
    assert "softhand-sim[parquet]" in told(store, "--out", out)
    assert not out.exists()
