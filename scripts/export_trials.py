"""Finished trials of a store (grasp_benchmark.py --store) as an Apache Parquet file, for pandas, Polars, R."""

from collections.abc import Sequence
from pathlib import Path

from scripts import _cli
from softhand_sim.benchmark.parquet import require_pyarrow, write_parquet
from softhand_sim.benchmark.report import trial_rows
from softhand_sim.benchmark.store import read_store

EXAMPLES = """examples:
  export_trials.py out/run.sqlite --out out/run.parquet     # while the run goes on, too
  export_trials.py out/run.sqlite --json out/run.json       # the same rows as JSON
"""


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("store", type=Path, metavar="STORE", help="SQLite file of grasp_benchmark.py --store")
    p.add_argument("--out", type=Path, metavar="FILE", help="Parquet file to write; needs pyarrow")
    p.add_argument("--json", type=Path, metavar="FILE", help="JSON file to write: conditions and rows")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    if args.out is None and args.json is None:
        raise ValueError("--out or --json: at least one is needed")
    _cli.check_writable(args.out, "--out")
    _cli.check_writable(args.json)
    if args.out is not None:
        require_pyarrow()
    conditions, results = read_store(args.store)
    if args.out is not None:
        write_parquet(args.out, results, conditions)
    if args.json is not None:
        _cli.write_json(args.json, {"conditions": conditions, "trials": trial_rows(results)})
    print(f"{len(results)} trials of {len({result.object for result in results})} objects")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
