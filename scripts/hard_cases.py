"""Hard cases of solid, gas and scene: every case at every time step, a heat map, and whether each ended as it may.

A case ends `finite` within its criteria, `warned` where the product said that the result is not to be relied on,
`typed` where it was refused by name or ended by a typed outcome, `diverged` or `wrong` where nothing said so; the last
two make the exit status 1. Cases of the solid have no time step and run once.
"""

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from tqdm import tqdm

from fea.stability.cases import SOLID_CASES
from scripts import _cli
from scripts._hard_page import DESCRIBED, draw, page
from softhand_sim.calibration import load_calibration
from softhand_sim.fidelity.fidelity import HIGH_ACCURACY
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.objects.catalogue import make_object
from softhand_sim.stability import hard_cases
from softhand_sim.stability.creep import HOLD_S, WITHOUT_CREEP, creep
from softhand_sim.stability.scene_runs import Grasped

EXAMPLES = """examples:
  hard_cases.py --json out/hard.json --picture out/hard.png            # all cases, all steps: some minutes
  hard_cases.py --cases "NaN,balloon" --steps 2
  hard_cases.py --kept out/hard.jsonl                                  # killed? the same line goes on
  hard_cases.py --creep lemon,tennis_ball --page docs/hard-cases.md    # with ten minutes of holding; the page in docs
"""
STEPS_MS = "0.25,0.5,1,2,4,8"
SILENT = ("wrong", "diverged")
PRESETS = {"default": EngineSettings(), "high_accuracy": HIGH_ACCURACY.engine, "without_creep": WITHOUT_CREEP}


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--cases", help="parts of names, comma-separated (default: all)")
    p.add_argument("--steps", default=STEPS_MS, metavar="MS,MS", help="time steps in ms (default %(default)s)")
    p.add_argument(
        "--kept", type=Path, metavar="FILE", help="JSON lines that keep each finished run; a second run goes on"
    )
    p.add_argument("--picture", type=Path, metavar="PNG", help="heat map of case and step")
    p.add_argument("--page", type=Path, metavar="MD", help="write the table as a page, with the heat map beside it")
    text = f"objects to be held for {HOLD_S / 60:g} minutes each, by default and with the settings against creep"
    p.add_argument("--creep", metavar="NAMES", help=text)
    p.add_common(seed="seed of the grasps' trials", json="write every run to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    for option in ("json", "kept", "picture", "page"):
        _cli.check_writable(getattr(args, option), f"--{option}")
    steps = _steps(args.steps)
    names = _names(args.cases)
    creeping = [] if args.creep is None else [make_object(name.strip()) for name in args.creep.split(",")]
    rows = _kept(args.kept, args.seed)
    known = {(row["name"], row["timestep_s"]) for row in rows}
    jobs = [job for job in _jobs(names, steps, args.seed) if job[:2] not in known]
    for name, step, run in tqdm(jobs, desc="cases", unit="run"):
        row = {"name": name, "timestep_s": step, **_outcome(run)}
        rows.append(row)
        if args.kept is not None:
            with args.kept.open("a", encoding="utf-8") as file:
                file.write(json.dumps({"seed": args.seed, **row}, allow_nan=False) + "\n")
    wanted = {(name, step) for name, step, _ in _jobs(names, steps, args.seed)}
    rows = sorted((row for row in rows if (row["name"], row["timestep_s"]) in wanted), key=_order(names))
    held = [_held(model, args.seed) for model in tqdm(creeping, desc="holding", unit="object", disable=not creeping)]
    _tell(rows, held)
    if args.json is not None:
        settings = {"seed": args.seed, "timesteps_s": steps}
        _cli.write_json(args.json, {"settings": settings, "cases": rows, "creep": held})
    for picture in (args.picture, args.page and args.page.with_suffix(".png")):
        if picture is not None:
            draw(picture, rows, steps)
    if args.page is not None:
        _cli.write_text(args.page, page(rows, steps, held, args.page.with_suffix(".png").name))
    return _cli.INCOMPLETE if any(row["outcome"] in SILENT for row in rows) else 0


def _steps(text: str) -> list[float]:
    try:
        found = [1e-3 * float(item) for item in text.split(",")]
    except ValueError:
        raise ValueError(f"--steps {text}: must be numbers in ms, comma-separated") from None
    for value in found:
        EngineSettings(timestep_s=value)
    if sorted(set(found)) != found:
        raise ValueError(f"--steps {text}: must increase")
    return found


def _names(wanted: str | None) -> list[str]:
    names = [*SOLID_CASES, *hard_cases()]
    if wanted is None:
        return names
    parts = [part.strip() for part in wanted.split(",")]
    for part in parts:
        if not any(part in name for name in names):
            raise ValueError(f"--cases {part}: no such case; there are {', '.join(names)}")
    return [name for name in names if any(part in name for part in parts)]


def _jobs(
    names: Sequence[str], steps: Sequence[float], seed: int
) -> Iterator[tuple[str, float | None, Callable[[], Any]]]:
    cases = hard_cases()
    for name in names:
        if name in SOLID_CASES:
            yield name, None, SOLID_CASES[name].run
            continue
        run = cases[name].run
        seeded = replace(run, seed=seed) if isinstance(run, Grasped) else run
        for step in steps:
            yield name, step, partial(seeded, step)


def _outcome(run: Callable[[], Any]) -> dict[str, Any]:
    """Return what a run came to; an error that no case expects is a wrong answer of the product."""
    try:
        found = asdict(run())
    except Exception as error:  # reported in the row: one case must not end the run
        text = " ".join(str(error).split())
        found = {
            "outcome": "wrong",
            "criterion": "no untyped error",
            "figure": 1.0,
            "detail": f"{type(error).__name__}: {text}",
        }
    return {**found, "outcome": str(found["outcome"])}


def _kept(file: Path | None, seed: int) -> list[dict[str, Any]]:
    if file is None or not file.is_file():
        return []
    rows = []
    for line in file.read_text(encoding="utf-8").splitlines():
        # a line that was cut when the run was killed
        with suppress(json.JSONDecodeError):
            rows.append(json.loads(line))
    return [{k: v for k, v in row.items() if k != "seed"} for row in rows if row.get("seed") == seed]


def _order(names: Sequence[str]) -> Callable[[dict[str, Any]], tuple[int, float]]:
    place = {name: k for k, name in enumerate(names)}
    return lambda row: (place[row["name"]], row["timestep_s"] or 0.0)


def _held(model: Any, seed: int) -> dict[str, Any]:
    """Hold one object by default and with the settings against creep."""
    calibration, out = load_calibration(), {"object": model.name, "hold_s": HOLD_S}
    for name, engine in PRESETS.items():
        found = creep(model, calibration, engine, seed)
        out[name] = {**asdict(found), "outcome": found.outcome.value, "engine": asdict(engine)}
    return out


def _tell(rows: Sequence[dict[str, Any]], held: Sequence[dict[str, Any]]) -> None:
    for row in rows:
        step = "-" if row["timestep_s"] is None else f"{1e3 * row['timestep_s']:g} ms"
        print(f"{row['name']:<40}{step:>8}  {row['outcome']:<9}{row['figure']:>10.3g}  {row['criterion']}")
        if row["outcome"] in SILENT:
            print(f"    {row['detail']}")
    for one in held:
        for name in PRESETS:
            found = one[name]
            print(
                f"{one['object']}, {name.replace('_', ' ')}: {found['outcome']}, creep "
                f"{1e6 * found['creep_m_per_s']:.2f} um/s, slip {1e3 * found['slip_m']:.2f} mm in {one['hold_s']:g} s, "
                f"{found['cone_share']:.0%} of its friction used"
            )
    counts = {word: sum(row["outcome"] == word for row in rows) for word in DESCRIBED}
    words = ", ".join(f"{n} {word}" for word, n in counts.items())
    print(f"{len({row['name'] for row in rows})} cases, {len(rows)} runs: {words}")


if __name__ == "__main__":
    raise SystemExit(main())
