"""Measure the three gradients: `python -m experiments.gradients --out docs/validation [--quick]`.

Writes gradients.md, gradients.png and gradients.json to the folder. Every measurement is a process of its own; none runs beside another.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from experiments.speed.settings import header

LENGTHS = (50, 100, 200, 400, 800)
QUICK_LENGTHS = (10, 20)
WINDOWS, UNITS = 64, 16


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m experiments.gradients", description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="folder for gradients.md, .png and .json")
    parser.add_argument("--quick", action="store_true", help="shrink everything to see that it works")
    parser.add_argument("--repeats", type=int, default=3, help="gradients of which the median time counts")
    parser.add_argument(
        "--redraw", action="store_true", help="write the page anew from gradients.json, without measuring"
    )
    arguments = parser.parse_args()
    for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"  # processor seconds of one core, which jobs beside this one change little

    from experiments.gradients.page import write
    from experiments.gradients.task import WAYS

    if arguments.redraw:
        write(arguments.out, json.loads((arguments.out / "gradients.json").read_text()))
        return 0
    rows: list[dict[str, Any]] = []
    for length in QUICK_LENGTHS if arguments.quick else LENGTHS:
        for way in WAYS:
            found = _measured(way, length, 4 if arguments.quick else WINDOWS, UNITS, arguments.repeats)
            rows.append({"way": way, "length": length, **found})
            print(f"{way:>16} {length:5}  " + "  ".join(f"{k} {v:.3g}" for k, v in found.items()), file=sys.stderr)
    about = {"windows": WINDOWS, "weights": 3 * UNITS + 1, "quick": arguments.quick, "repeats": arguments.repeats}
    write(arguments.out, {**about, "machine": header(), "rows": rows})
    return 0


def _measured(way: str, length: int, windows: int, units: int, repeats: int) -> dict[str, float]:
    numbers = [str(n) for n in (length, windows, units, repeats)]
    command = [sys.executable, "-m", "experiments.gradients.measure", way, *numbers]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{way} at {length} samples failed:\n{done.stderr}")
    return json.loads(done.stdout)


if __name__ == "__main__":
    sys.exit(main())
