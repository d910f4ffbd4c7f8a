"""A few dozen examples of each property; ``HYPOTHESIS_PROFILE=full`` runs 2,000, as scripts/property_run.py does."""

import json
import os

import pytest
from hypothesis import HealthCheck, given, settings

from scripts import _properties, property_run
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.stability.properties import PROPERTIES, Property

# choice: the share of the trials, the slowest property, is about a third of either number
EXAMPLES = 2000 if os.environ.get("HYPOTHESIS_PROFILE") == "full" else 48
WEIGHTS = sum(one.weight for one in _properties.ALL.values())
QUICK = settings(deadline=None, database=None, derandomize=True, suppress_health_check=list(HealthCheck))


@pytest.mark.parametrize("name", _properties.ALL)
def test_no_crash_no_silent_nan_only_typed_errors(name, tmp_path):
    share = max(4, round(EXAMPLES * _properties.ALL[name].weight / WEIGHTS))

    @settings(QUICK, max_examples=share)
    @given(_properties.examples(name))
    def checked(example):
        end = _properties.check(name, example, tmp_path)
        assert end in ("refused", "kept", *Outcome)

    checked()


def test_a_failure_shrinks_to_a_replay_file(tmp_path, monkeypatch, capsys):
    """A crash that a negative mass would cause: the file holds the simplest example, and repeats it."""

    def broken(*, mass_kg, word):
        if mass_kg < -0.5:
            raise ZeroDivisionError(f"crash with {word}")
        return "kept"

    bad = Property(name="broken", spans={"mass_kg": (0.1, 1.0), "word": ("a", "b")}, check=broken)
    monkeypatch.setattr(_properties, "ALL", {**PROPERTIES, "broken": bad})
    command = ["--properties", "broken", "--examples", "300", "--failures", str(tmp_path)]
    assert property_run.main([*command, "--json", str(tmp_path / "run.json")]) == 1
    assert "FAILED: ZeroDivisionError: crash with a" in capsys.readouterr().out
    (file,) = tmp_path.glob("broken_*.json")
    name, example = _properties.load_example(file)
    assert name == "broken"
    assert example["word"] == "a"
    assert example["mass_kg"] < 0.0
    with pytest.raises(AssertionError, match="crash"):
        property_run.main(["--replay", str(file)])
    monkeypatch.setattr(
        _properties, "ALL", {**PROPERTIES, "broken": Property(name="broken", spans=bad.spans, check=lambda **_: "kept")}
    )
    assert property_run.main(["--replay", str(file)]) == 0


def test_examples_are_drawn_from_their_spans_and_some_are_odd():
    seen = []

    @settings(QUICK, max_examples=200)
    @given(_properties.examples("gas"))
    def drawn(example):
        seen.append(example)

    drawn()
    spans = PROPERTIES["gas"].spans
    inside = [
        all(not isinstance(span[0], float) or span[0] <= e[k] <= span[1] for k, span in spans.items()) for e in seen
    ]
    assert 0.75 < sum(inside) / len(inside) < 0.99
    assert {e["tubes"] for e in seen} == {"plain", "heat", "tubes"}


@pytest.mark.parametrize(
    "text", ["no json", "{}", '{"property": "gas", "example": {}}', '{"property": "x", "example": {"a": 1}}']
)
def test_files_that_are_no_example_are_refused(text, tmp_path):
    file = tmp_path / "bad.json"
    file.write_text(text)
    assert property_run.main(["--replay", str(file)]) == 2
    assert property_run.main(["--replay", str(tmp_path / "none.json")]) == 2
    assert property_run.main(["--properties", "none"]) == 2


def test_numbers_that_json_has_no_word_for_come_back(tmp_path):
    data = {
        "property": "shape",
        "example": {"kind": "box", "a_m": "NaN", "b_m": "Infinity", "c_m": 1.0, "mass_kg": 1.0, "friction": 0.0},
    }
    file = tmp_path / "odd.json"
    file.write_text(json.dumps(data))
    _, example = _properties.load_example(file)
    assert example["a_m"] != example["a_m"]
    assert example["b_m"] == float("inf")
    assert property_run.main(["--replay", str(file)]) == 0
