"""Real recordings with known physics concealed from the model: does the tool find it?

    python -m experiments.recordings OUT [--only NAME,…] [--time-limit 300]

Runs `greybox diagnose` on every recording with the model that lacks something, and `greybox fit` with the full published model, as a user
would. Writes OUT/results.json and OUT/results.md; what has been run is passed over, so that an interrupted run goes on where it was.
Recordings that are not beside the checkout (../shared/recordings) are skipped, saying so.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from experiments.recordings.cases import CASES, HERE, Case
from experiments.recordings.table import row, table
from experiments.verdicts.running import ROOT, VERDICT, diagnose, has_verdict
from greybox_torch.errors import UserError, did_you_mean
from greybox_torch.files import json_text, write_text


def run_case(case: Case, out: Path, time_limit: float) -> tuple[dict[str, Any], dict[str, Any]]:
    """The verdict on a recording and the fit of the published model, from files where they have been made before.

    Raises:
        UserError: one of the two commands failed; the message is its own.
    """
    folder = out / "".join(c if c.isalnum() else "_" for c in case.name.lower()).strip("_")
    if not has_verdict(folder):
        outcome = diagnose(HERE / case.card, folder, time_limit)
        if outcome.failure:
            raise UserError(f"greybox diagnose {case.card}: {outcome.failure}")
    published = folder / "published"
    if not (published / "fit.json").exists():
        model = ["--model", str(HERE / case.published_model)] if case.published_model else []
        arguments = ["fit", str(HERE / case.published_card), "--out", str(published), *model]
        command = [sys.executable, "-m", "greybox_torch", *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
        if done.returncode != 0:
            raise UserError(f"greybox {' '.join(arguments)}: {done.stderr.strip()}")
    return json.loads((folder / VERDICT).read_text()), json.loads((published / "fit.json").read_text())


def chosen(names: str) -> list[Case]:
    """The cases of a comma-separated list, all where it is empty. Raises UserError where a name is unknown."""
    by_name = {case.name: case for case in CASES}
    wanted = [name.strip() for name in names.split(",") if name.strip()] or list(by_name)
    unknown = [name for name in wanted if name not in by_name]
    if unknown:
        raise UserError(
            f"--only: no recording is called {unknown[0]}{did_you_mean(unknown[0], by_name)}; expected some of {', '.join(by_name)}"
        )
    return [by_name[name] for name in wanted]


def main(arguments: Sequence[str] | None = None) -> int:
    """0 where everything that is there was run, 1 where a command failed, 2 where the arguments are at fault."""
    options = _parsed(arguments)
    out = options.out.resolve()
    try:
        cases = chosen(options.only)
    except UserError as error:
        print(error, file=sys.stderr)
        return 2
    rows, failed = [], 0
    for case in cases:
        if not case.recordings.is_dir():
            print(f"{case.name}: skipped, ../shared/recordings/{case.folder} is not here", file=sys.stderr)
            continue
        began = time.perf_counter()
        try:
            rows.append(row(case, *run_case(case, out, options.time_limit)))
        except UserError as error:
            failed += 1
            print(f"{case.name}: {error}", file=sys.stderr)
            continue
        print(f"{case.name}: {time.perf_counter() - began:.0f} s", file=sys.stderr, flush=True)
        write_text(out / "results.json", json_text({"time_limit": options.time_limit, "recordings": rows}))
        write_text(out / "results.md", table(rows))
    if rows:
        print(table(rows))
    return int(failed > 0)


def _parsed(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m experiments.recordings", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("out", type=Path, metavar="OUT", help="folder for verdicts, fits, results.json and results.md")
    parser.add_argument("--only", default="", help="names of recordings, separated by commas")
    parser.add_argument("--time-limit", type=float, default=300.0, help="seconds for the search on one recording")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.exit(main())
