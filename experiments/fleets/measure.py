"""The measurements on a fleet that lies in files."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from experiments.fleets.generate import MODEL, write_fleet
from experiments.fleets.judging import same_verdict
from experiments.fleets.plan import draw_fleet
from experiments.fleets.running import Fleet, diagnosed_alone, done_rows

LENGTHS = (1, 4, 16)
"""Times as long as the fleet's recordings, for how the cost grows."""


def interrupted(root: Path, out: Path, workers: int, count: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """The fleet's result where a worker is killed after a quarter of the ``count`` data sets, and the command after a half, and it is begun
    again; and what became of the work.
    """
    with Fleet(root, out, workers) as first:
        first.wait_until(lambda: len(done_rows(out)) >= count // 4)
        first.kill_a_worker()
        first.wait_until(lambda: len(done_rows(out)) >= count // 2)
        first.kill()
    before = done_rows(out)
    with Fleet(root, out, workers) as second:
        ran = second.finish()
    after = done_rows(out)
    failed = [row["dataset"] for row in ran.result["machines"] if row["answer"] == "failed"]
    return ran.result, {
        "data_sets": count,
        "rows": len(ran.result["machines"]),
        "failed": failed,
        "done_before_the_restart": len(before),
        "of_them_done_again": sum(after[path] != when for path, when in before.items()),
        "restart_seconds": ran.seconds,
        "worker_memory": ran.worker_memory,
        "own_memory": ran.own_memory,
        "diagnosing_seconds": [row["seconds"] for row in ran.result["machines"]],
        "stages": _stages(out),
    }


def alone(cards: Sequence[Path], out: Path) -> dict[str, Any]:
    """Whether verdicts of the fleet are those of `greybox diagnose`, one after the other."""
    different, processor = [], []
    for k, card in enumerate(cards):
        own, taken = diagnosed_alone(card, out / "alone" / str(k))
        name = card.parent.relative_to(out / "data")
        fleet = json.loads((out / "fleet" / name / "verdict.json").read_text())
        processor.append(taken["processor"])
        if not same_verdict(own, fleet):
            different.append(str(name))
    return {"compared": len(cards), "different": different, "processor": processor}


def throughput(
    cards: Sequence[Path], out: Path, workers: Sequence[int], *, data: Path | None = None
) -> list[dict[str, float]]:
    """The same data sets by so many workers: seconds from the first that is done to the last, and of processors.

    Args:
        data: the folder that the cards lie below; OUT/data by default.
    """
    root, data = out / "throughput" / "data", data or out / "data"
    for card in cards:
        folder = root / card.parent.relative_to(data)
        shutil.copytree(card.parent, folder)
    shutil.copyfile(data / MODEL.name, root / MODEL.name)
    found = []
    for count in workers:
        place = out / "throughput" / f"by_{count}"
        with Fleet(root, place, count) as fleet:
            ran = fleet.finish()
        times = sorted(done_rows(place).values())
        found.append(
            {
                "workers": count,
                "data_sets": len(times),
                "seconds": ran.seconds,
                "per_second": (len(times) - count) / (1e-9 * (times[-1] - times[count - 1])),
                "processor": ran.processor,
                "load": os.getloadavg()[0],
            }
        )
    return found


def growth(out: Path, samples: int, seed: int) -> list[dict[str, float]]:
    """What `greybox diagnose` takes for one machine with an effect and recordings of different lengths, twice, the second time counting:
    the first compiles what is not compiled yet.
    """
    machine = next(m for m in draw_fleet(16, 1, seed) if m.effect == "coulomb" and m.sizes[0] > 0.0)
    found = []
    for times in LENGTHS:
        folder = out / "growth" / str(times)
        (card,) = write_fleet([machine], folder, samples=times * samples, seed=seed)
        for _ in range(2):
            _, taken = diagnosed_alone(card, folder / "found")
        found.append({"samples": 2 * times * samples, **taken})
    return found


def _stages(out: Path) -> dict[str, float]:
    """Mean seconds of the stages of all diagnoses."""
    sums: dict[str, float] = {}
    files = list(out.rglob("verdict.json"))
    for file in files:
        for name, seconds in json.loads(file.read_text()).get("stages", {}).items():
            sums[name] = sums.get(name, 0.0) + seconds
    return {name: seconds / len(files) for name, seconds in sums.items()}
