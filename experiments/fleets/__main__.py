"""A year of a simulated fleet, diagnosed while workers are killed: `python -m experiments.fleets --machines 64 --out results/fleets`.

Motors with Coulomb friction, drag, a dead zone of the drive, or (a quarter) nothing, each recorded some times in a year; half of those with
an effect change about the middle of the year. Measured are

- whether verdicts are those that `greybox diagnose` gives one by one, whether they are right, whether changes are dated;
- what becomes of the work when a worker is killed after a quarter of it, and the command itself after a half, and it is begun again;
- how two workers compare with one, what a data set costs, how that grows with its length, and where the time goes.

`--only throughput` measures one worker against two alone, with steppers in the cache: on a quiet machine,
`OMP_NUM_THREADS=1 python -m experiments.fleets --only throughput --recordings 1 --throughput 64`.

Writes OUT/measured.json and OUT/measured.md.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from pathlib import Path

from experiments.fleets.generate import write_fleet
from experiments.fleets.judging import judged
from experiments.fleets.measure import alone, growth, interrupted, throughput
from experiments.fleets.page import page
from experiments.fleets.plan import draw_fleet
from experiments.fleets.running import FleetFailed
from experiments.speed.settings import header

FEWEST = 4
"""Data sets that throughput can be measured with."""


def main(arguments: list[str] | None = None) -> int:
    """0 where all was measured."""
    chosen = _parsed(arguments)
    out: Path = chosen.out
    shutil.rmtree(out, ignore_errors=True)
    planned = draw_fleet(chosen.machines, chosen.recordings, chosen.seed)[: chosen.first]
    cards = write_fleet(planned, out / "data", samples=chosen.samples, seed=chosen.seed)
    (out / "key.json").write_text(json.dumps([machine.as_json() for machine in planned], indent=1))
    measured = {"about": header(), "choices": {k: v for k, v in vars(chosen).items() if k != "out"}}
    if chosen.only == "throughput":
        _tell("steppers into the cache")
        throughput(cards[:8], out / "warm", (2,), data=out / "data")
        _tell(f"throughput of one worker and of two on {chosen.throughput} data sets")
        measured["throughput"] = throughput(cards[: chosen.throughput], out, (1, 2))
        (out / "measured.json").write_text(json.dumps(measured, indent=1))
        print(json.dumps(measured["throughput"], indent=1))
        return 0
    try:
        _tell(f"{len(cards)} data sets with {chosen.workers} workers, one of them killed, and the command as well")
        result, measured["interrupted"] = interrupted(out / "data", out / "fleet", chosen.workers, len(cards))
        measured["judged"] = judged(planned, result)
        _tell(str(measured["judged"]))
        some = cards[:: max(1, len(cards) // chosen.compared)][: chosen.compared]
        _tell(f"{len(some)} of them one by one")
        measured["alone"] = alone(some, out)
        _tell("throughput of one worker and of two")
        measured["throughput"] = throughput(cards[: chosen.throughput], out, (1, 2))
        _tell("longer recordings")
        measured["growth"] = growth(out, chosen.samples, chosen.seed)
    except FleetFailed as error:
        print(error, file=sys.stderr)
        return 3
    finally:
        (out / "measured.json").write_text(json.dumps(measured, indent=1))
    (out / "measured.md").write_text(page(measured))
    print(page(measured))
    return 0


def _tell(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def _parsed(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--machines", type=int, default=64)
    parser.add_argument("--first", type=int, help="so many of them alone are recorded")
    parser.add_argument("--recordings", type=int, default=10, help="of each machine")
    parser.add_argument("--samples", type=int, default=300, help="of each of the two experiments of a recording")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--compared", type=int, default=12, help="data sets that are diagnosed one by one as well")
    parser.add_argument("--throughput", type=int, default=32, help="data sets that throughput is measured with")
    parser.add_argument("--only", choices=["throughput"], help="measure nothing else")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("results/fleets"))
    chosen = parser.parse_args(arguments)
    drawn = chosen.recordings * min(chosen.machines, chosen.first or chosen.machines)
    if min(drawn, chosen.throughput) < FEWEST:
        parser.error(
            f"--throughput: found {min(drawn, chosen.throughput)} data sets, expected at least {FEWEST}: the first of every worker do "
            "not count"
        )
    return chosen


if __name__ == "__main__":
    raise SystemExit(main())
