"""Properties of both packages, hypothesis strategies for their examples, and replay files of those that fail."""

import hashlib
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from fea.stability.properties import SOLID_PROPERTIES
from scripts import _cli
from softhand_sim.stability.properties import PROPERTIES

ALL: Mapping[str, Any] = {**SOLID_PROPERTIES, **PROPERTIES}
ODD = (0.0, -1.0, math.nan, math.inf, -math.inf, 1e-300, 1e300)
"""Choice: what one value is instead, or beyond an end of its span by a thousandth, in one example of eight."""
_WORDS = {"NaN": math.nan, "Infinity": math.inf, "-Infinity": -math.inf}


def examples(name: str) -> st.SearchStrategy[dict[str, Any]]:
    """Return the strategy of a property's examples: values in their spans, in one of eight with one odd number."""
    spans = ALL[name].spans
    plain = st.fixed_dictionaries({key: _values(span) for key, span in spans.items()})
    odd = st.sampled_from([key for key, span in spans.items() if isinstance(span[0], float)]).flatmap(
        lambda key: st.sampled_from((*ODD, *_beyond(spans[key]))).map(lambda value: {key: value})
    )
    # one_of would draw either as often
    change = st.integers(0, 7).flatmap(lambda k: odd if k == 7 else st.just(dict[str, Any]()))
    return st.tuples(plain, change).map(lambda pair: {**pair[0], **pair[1]})


def _beyond(span: tuple[Any, ...]) -> tuple[float, float]:
    low, high = span
    return low - 1e-3 * (high - low), high + 1e-3 * (high - low)


def _values(span: tuple[Any, ...]) -> st.SearchStrategy[Any]:
    if isinstance(span[0], str):
        return st.sampled_from(span)
    if isinstance(span[0], int):
        return st.integers(*span)
    low, high = span
    if low > 0.0 and high > 30.0 * low:
        # decades alike
        return st.floats(math.log(low), math.log(high)).map(lambda x: min(max(math.exp(x), low), high))
    return st.floats(low, high)


def check(name: str, example: Mapping[str, Any], folder: Path) -> str:
    """Check one example; where it fails, write it to a replay file of the folder and raise.

    Raises
    ------
    AssertionError
        With the failure and the file, which shrinking overwrites with ever simpler examples.
    """
    try:
        return str(ALL[name].check(**example))
    except Exception as error:
        file = folder / f"{name}_{_mark(error)}.json"
        plain = {key: _word(value) for key, value in example.items()}
        failure = f"{type(error).__name__}: {error}"
        _cli.write_json(file, {"property": name, "example": plain, "failure": failure})
        raise AssertionError(f"{failure}; repeat: scripts/property_run.py --replay {file}") from error


def load_example(file: Path) -> tuple[str, dict[str, Any]]:
    """Return a replay file's property and example.

    Raises
    ------
    FileNotFoundError, ValueError
        If there is no such file, or it is none.
    """
    if not file.is_file():
        raise FileNotFoundError(f"no replay file at {file}")
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
        name, example = (
            str(data["property"]),
            {str(k): _WORDS.get(v, v) if isinstance(v, str) else v for k, v in data["example"].items()},
        )
        known = set(ALL[name].spans)
    except (json.JSONDecodeError, UnicodeDecodeError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"{file}: not a replay file of a property: {type(error).__name__} {error}") from error
    if set(example) != known:
        raise ValueError(f"{file}: example has {sorted(example)}, {name} takes {sorted(known)}")
    return name, example


def _word(value: Any) -> Any:
    """Return a value as JSON can hold it: numbers that are none as words."""
    if isinstance(value, float) and not math.isfinite(value):
        return next(
            word for word, known in _WORDS.items() if known == value or (math.isnan(known) and math.isnan(value))
        )
    return value


def _mark(error: Exception) -> str:
    # one file for each kind of failure: the last one written is the shrunk one
    return hashlib.sha256(type(error).__name__.encode()).hexdigest()[:8]
