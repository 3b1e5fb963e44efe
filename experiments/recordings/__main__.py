"""Real recordings with known physics concealed from the model: does the tool find it?

    python -m experiments.recordings OUT [--only NAME,…] [--time-limit 300] [--workers 1]

Runs `greybox diagnose` on every recording with the model that lacks something, and `greybox fit` with the full published model where there
is one, as a user would. Writes OUT/results.json and OUT/results.md; what has been run is passed over, so that an interrupted run goes on
where it was. Recordings that are not beside the checkout (../shared/recordings) are skipped, saying so.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

from experiments.recordings.cases import CASES, HERE, Case
from experiments.recordings.table import row, table
from experiments.verdicts.running import ROOT, VERDICT, Outcome, diagnose_all, has_verdict
from greybox_torch import UserError
from greybox_torch.errors import did_you_mean
from greybox_torch.files import json_text, write_text


def published_fit(case: Case, out: Path) -> dict[str, Any] | None:
    """The fit of the full published model, from its file where it has been made before; None where there is no such model.

    Raises:
        UserError: the fit failed; the message is the command's.
    """
    if not case.published_card:
        return None
    folder = out / f"{case.slug}_published"
    if not (folder / "fit.json").exists():
        model = ["--model", str(HERE / case.published_model)] if case.published_model else []
        arguments = ["fit", str(HERE / case.published_card), "--out", str(folder), *model]
        command = [sys.executable, "-m", "greybox_torch", *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
        if done.returncode != 0:
            raise UserError(f"greybox {' '.join(arguments)}: {done.stderr.strip()}")
    return json.loads((folder / "fit.json").read_text())


def verdicts(cases: Sequence[Case], out: Path, *, workers: int, time_limit: float) -> list[str]:
    """Diagnose what has no verdict yet, into OUT/SLUG; the names of the recordings on which that failed."""
    by_slug = {case.slug: case.name for case in cases}
    left = {case.slug: HERE / case.card for case in cases if not has_verdict(out / case.slug)}
    failed: list[str] = []

    def tell(slug: str, outcome: Outcome) -> None:
        failed.extend([by_slug[slug]] * bool(outcome.failure))
        print(f"{by_slug[slug]} {outcome.seconds:.0f} s: {outcome.said}", file=sys.stderr, flush=True)

    diagnose_all(left, out, workers=workers, time_limit=time_limit, tell=tell)
    return failed


def chosen(names: str) -> list[Case]:
    """The cases of a comma-separated list, all where it is empty. Raises UserError where a name is unknown."""
    by_name = {case.name: case for case in CASES}
    wanted = _listed(names, by_name) or list(by_name)
    unknown = [name for name in wanted if name not in by_name]
    if unknown:
        raise UserError(
            f"--only: no recording is called {unknown[0]}{did_you_mean(unknown[0], by_name)}; expected some of {', '.join(by_name)}"
        )
    return [by_name[name] for name in wanted]


def _listed(names: str, known: Collection[str]) -> list[str]:
    """The names of a list, some of which have commas of their own; what is no name stays in one piece up to the next comma."""
    parts, found = [name.strip() for name in names.split(",") if name.strip()], []
    while parts:
        lengths = (n for n in range(len(parts), 0, -1) if ", ".join(parts[:n]) in known)
        taken = next(lengths, 1)
        found.append(", ".join(parts[:taken]))
        parts = parts[taken:]
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """0 where everything that is there was run, 1 where a command failed, 2 where the arguments are at fault."""
    options = _parsed(arguments)
    out = options.out.resolve()
    try:
        cases = chosen(options.only)
    except UserError as error:
        print(error, file=sys.stderr)
        return 2
    there = [case for case in cases if case.recordings.is_dir()]
    for case in cases:
        if case not in there:
            print(f"{case.name}: skipped, ../shared/recordings/{case.folder} is not here", file=sys.stderr)
    if not there:
        return 0
    failed = verdicts(there, out, workers=options.workers, time_limit=options.time_limit)
    rows = []
    for case in there:
        if case.name in failed:
            continue
        try:
            verdict = json.loads((out / case.slug / VERDICT).read_text(encoding="utf-8"))
            rows.append(row(case, verdict, published_fit(case, out)))
        except UserError as error:
            failed.append(case.name)
            print(f"{case.name}: {error}", file=sys.stderr)
            continue
        write_text(out / "results.json", json_text({"time_limit": options.time_limit, "recordings": rows}))
        write_text(out / "results.md", table(rows))
    if rows:
        print(table(rows))
    return int(bool(failed))


def _parsed(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m experiments.recordings", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("out", type=Path, metavar="OUT", help="folder for verdicts, fits, results.json and results.md")
    parser.add_argument("--only", default="", help="names of recordings, separated by commas")
    parser.add_argument("--time-limit", type=float, default=300.0, help="seconds for the search on one recording")
    parser.add_argument("--workers", type=int, default=1, help="recordings side by side, which share the cores")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.exit(main())
