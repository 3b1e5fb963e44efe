"""Diagnose every case of a folder: `python -m experiments.concealed.benchmark CASES VERDICTS [NAME …]`.

Writes VERDICTS/NAME/{verdict.json, report.html, model.*} by running `greybox diagnose` on CASES/NAME/dataset.toml, as a user would. Cases
that have a verdict are passed over, so that an interrupted run goes on where it was. Keys are never read.
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path


def main(cases: Path, verdicts: Path, names: list[str]) -> int:
    """The number of cases that ended without a verdict."""
    chosen = names or sorted(card.parent.name for card in cases.glob("*/dataset.toml"))
    failed = 0
    for number, name in enumerate(chosen, start=1):
        folder = verdicts / name
        if (folder / "verdict.json").exists():
            continue
        began = time.perf_counter()
        command = [
            sys.executable,
            "-m",
            "greybox_torch",
            "diagnose",
            str(cases / name / "dataset.toml"),
            "--out",
            str(folder),
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        failed += done.returncode != 0
        lines = (done.stdout if done.returncode == 0 else done.stderr).strip().splitlines()
        sentence = next(
            (line for line in lines if line.startswith(("The mismatch", "Nothing"))), lines[-1] if lines else ""
        )
        print(f"{number}/{len(chosen)} {name} {time.perf_counter() - began:.0f} s: {sentence}", flush=True)
    return failed


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:]))
