"""`greybox demo`: `diagnose` on the data set that comes with the package."""

from __future__ import annotations

from pathlib import Path

from greybox_torch.commands import diagnose
from greybox_torch.commands.options import Options
from greybox_torch.demo import DATASET


def run(options: Options, settings: Path | None = None, *, pdf: bool = False) -> None:
    """Diagnoses a simulated arm with one concealed effect; results go to results/demo unless --out says otherwise."""
    diagnose.run(DATASET, None, options, settings, pdf=pdf)
