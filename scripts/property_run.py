"""Property tests by the thousand: any geometry, material, gas, object and trial; no crash, no silent NaN.

Hypothesis draws the examples, some with numbers outside their spans, NaN and infinity among them, and shrinks what
fails to the simplest example that still does. That is written as a replay file.
"""

import sys
from collections import Counter
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # run as a file: here "fea" is the script beside this one, not the package
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from tqdm import tqdm

from scripts import _cli

EXAMPLES = """examples:
  property_run.py --examples 2000 --json out/properties.json
  property_run.py --properties gas,trial --examples 200 --seed 7
  property_run.py --replay out/properties/trial_1a2b3c4d.json
"""


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--examples", type=_cli.positive_int, default=2000, help="in all (default %(default)s)")
    p.add_argument("--properties", help="names, comma-separated (default: all)")
    p.add_argument("--failures", type=Path, default=Path("out/properties"), metavar="DIR", help="for replay files")
    p.add_argument("--replay", type=Path, metavar="FILE", help="check the example of a file, and nothing else")
    p.add_common(seed="seed of the examples", json="write counts and failures to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    if find_spec("hypothesis") is None:
        raise ValueError("property tests need hypothesis (pip install 'softhand-sim[dev]')")
    from scripts import _properties  # noqa: PLC0415 - hypothesis is for development

    if args.replay is not None:
        name, example = _properties.load_example(args.replay)
        print(f"{name}: {_properties.check(name, example, args.replay.parent)}")
        return 0
    names = list(_properties.ALL) if args.properties is None else [n.strip() for n in args.properties.split(",")]
    for name in names:
        if name not in _properties.ALL:
            raise ValueError(f"--properties {name}: no such property; there are {', '.join(_properties.ALL)}")
    weights = {name: _properties.ALL[name].weight for name in names}
    rows = []
    with tqdm(total=args.examples, desc="examples", unit="example") as bar:
        for name in names:
            share = max(1, round(args.examples * weights[name] / sum(weights.values())))
            rows.append(_run(name, share, args.seed, args.failures, bar))
    for row in rows:
        ends = ", ".join(f"{count} {word}" for word, count in row["ends"].items())
        print(f"{row['property']}: {row['examples']} examples: {ends}")
        if row["failure"]:
            print(f"  FAILED: {row['failure']}")
    if args.json is not None:
        _cli.write_json(args.json, {"settings": {"seed": args.seed, "examples": args.examples}, "properties": rows})
    return _cli.INCOMPLETE if any(row["failure"] for row in rows) else 0


def _run(name: str, count: int, seed: int, folder: Path, bar: Any) -> dict[str, Any]:
    """Check a property on some examples; return what came out."""
    from hypothesis import HealthCheck, given, settings  # noqa: PLC0415 - for development
    from hypothesis import seed as seeded  # noqa: PLC0415 - for development

    from scripts import _properties  # noqa: PLC0415 - hypothesis is for development

    ends: Counter[str] = Counter()

    @seeded(seed)
    @settings(
        max_examples=count,
        deadline=None,
        database=None,
        report_multiple_bugs=False,
        suppress_health_check=list(HealthCheck),
    )
    @given(_properties.examples(name))
    def checked(example: dict[str, Any]) -> None:
        bar.update()
        ends[_properties.check(name, example, folder)] += 1

    failure = ""
    try:
        checked()
    except AssertionError as error:
        failure = " ".join(str(error).split())
    return {"property": name, "examples": sum(ends.values()), "ends": dict(sorted(ends.items())), "failure": failure}


if __name__ == "__main__":
    raise SystemExit(main())
