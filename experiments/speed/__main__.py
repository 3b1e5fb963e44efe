"""Measure the engine beside other tools: `make bench`, or

python -m experiments.speed --out results/bench [--only free_run,growth] [--quick] [--draws 40] [--against COMMIT] [--cases "demo;d01"]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from experiments.speed.settings import Settings, bind_to_cores, header


def main() -> int:
    """0 where every row was measured, 1 where one was skipped or failed; targets that are missed are a result like any other."""
    arguments = _parsed()
    bind_to_cores()

    from rich.console import Console

    from experiments.speed.plot import draw_growth
    from experiments.speed.row import skipped
    from experiments.speed.rows import KEYS, measure
    from experiments.speed.writers import print_header, print_row, write

    chosen = tuple(arguments.only.split(",")) if arguments.only else KEYS
    unknown = [key for key in chosen if key not in KEYS]
    if unknown:
        print(f"--only: no row is called {', '.join(unknown)}; expected some of {','.join(KEYS)}", file=sys.stderr)
        return 2
    console, aside = Console(width=None if sys.stdout.isatty() else 150), Console(stderr=True, highlight=False)
    cases = tuple(name.strip() for name in arguments.cases.split(";") if name.strip())
    settings = Settings(arguments.quick, arguments.draws, arguments.seed, arguments.against, cases)
    about, rows = header(), []
    if settings.quick:
        about = {"quick": "everything shrunk to see that it works; the numbers mean nothing"} | about
    print_header(console, about)
    for key in chosen:
        try:
            row = measure(key, settings, lambda text, key=key: aside.print(f"{key}: {text}", markup=False))
        except Exception as error:  # one row that fails must not lose the others
            row = skipped(key, key, f"failed, {type(error).__name__}: {error}")
        rows.append(row)
        print_row(console, row)
        write(arguments.out, about, rows)  # after every row, so that an interrupted run leaves what it has
        if row.curves:
            draw_growth(row, arguments.out / "growth.png")
    console.print(f"results in {arguments.out}", highlight=False)
    return int(any(row.skipped for row in rows))


def _parsed() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m experiments.speed", description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="folder for results.json, results.md and growth.png")
    parser.add_argument("--only", default="", help="rows to measure, by name and separated by commas")
    parser.add_argument("--quick", action="store_true", help="shrink everything to see that it works")
    parser.add_argument("--draws", type=int, default=40, help="start values of the robustness row")
    parser.add_argument("--seed", type=int, default=1, help="of those start values")
    parser.add_argument("--against", default="", metavar="COMMIT", help="a commit that diagnoses are measured beside")
    parser.add_argument(
        "--cases", default="", help="those that are diagnosed, by name and separated by semicolons (all)"
    )
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
