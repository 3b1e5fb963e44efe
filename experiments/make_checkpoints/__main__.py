"""Make the checkpoints of the repository anew.

    python -m experiments.make_checkpoints [--verdict DIR] [--only demo|robot_arm] [--work DIR] [--out DIR]

fits, trains and diagnoses (the demo in some minutes, the real arm in a quarter of an hour), and writes the models with their verdict
and a page of figures to `checkpoints/`, a machine at a time and whole or not at all. Interrupted, the same command goes on with what
`--work` holds. `--verdict` takes a diagnosis of the real arm that is there already. Without its recordings the real arm is left as it is.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from experiments.make_checkpoints.machines import CHECKOUT, MACHINES, Machine
from experiments.make_checkpoints.page import page, size
from experiments.make_checkpoints.steps import Made, made
from greybox_torch import evaluate, load_checkpoint, load_dataset
from greybox_torch.checkpoint import checkpoint_files
from greybox_torch.errors import GreyboxError
from greybox_torch.files import json_text, write_all

MOST_BYTES = 1_000_000
REAL = "robot_arm"


def main(arguments: list[str] | None = None) -> int:
    chosen = _parsed(arguments)
    try:
        for machine in MACHINES:
            if chosen.only in (None, machine.name):
                make(machine, chosen.work, chosen.out, chosen.verdict if machine.name == REAL else None)
    except GreyboxError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    total = size(chosen.out)
    print(f"{chosen.out}: {total / 1000:.0f} kB in all")
    return 0 if total < MOST_BYTES else 1


def make(machine: Machine, work: Path, out: Path, named: Path | None) -> None:
    """The checkpoints of one machine, its verdict and its page. Raises UserError where a step refuses its input."""
    if machine.name == REAL and not (CHECKOUT.parent / "shared" / "recordings").is_dir():
        print(f"{machine.name}: its recordings are not there (../shared/recordings); left as it is")
        return
    result = made(machine, work, named)
    keep(machine, result, out / machine.name)


def keep(machine: Machine, result: Made, folder: Path) -> None:
    """Writes the models, the verdict and the page of figures to ``folder``: all of them, or none."""
    data = load_dataset(machine.card)
    kept = {name: load_checkpoint(where / "model") for name, where in result.models.items()}
    runs = {"start": evaluate(data)} | {name: evaluate(data, at / "model") for name, at in result.models.items()}
    verdict = json.loads((result.named / "verdict.json").read_text(encoding="utf-8"))
    files: dict[Path, str | bytes] = {}
    for name, checkpoint in kept.items():
        files |= checkpoint_files(folder / name, checkpoint)
    files[folder / "verdict.json"] = json_text(verdict)
    files[folder / "README.md"] = page(machine, data, result, runs, kept, verdict["sentence"])
    write_all(files)


def _parsed(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--verdict", type=Path, metavar="DIR", help="what `greybox diagnose` has written of the real arm"
    )
    parser.add_argument("--only", choices=[machine.name for machine in MACHINES])
    parser.add_argument(
        "--work", type=Path, default=Path("results/checkpoints"), metavar="DIR", help="results of the single steps"
    )
    parser.add_argument("--out", type=Path, default=CHECKOUT / "checkpoints", metavar="DIR")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.exit(main())
