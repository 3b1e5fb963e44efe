from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from greybox_torch.fleets.job import Choices, Job
from greybox_torch.fleets.row import Row

CARD = """\
sample_time = 0.01

[channels]
voltage = { column = "v", unit = "V" }

[[experiment]]
name = "Steps"
file = "steps.csv"

[model]
name = "my_motor.py:Motor"
"""


@pytest.fixture
def job(tmp_path: Path) -> Job:
    """A data set with its card, its recording and its model's file, none of which is ever run."""
    folder = tmp_path / "in" / "pump"
    folder.mkdir(parents=True)
    (folder / "dataset.toml").write_text(CARD)
    (folder / "steps.csv").write_text("v\n1\n2\n")
    (folder / "my_motor.py").write_text("class Motor: ...\n")
    return Job("pump", folder / "dataset.toml", tmp_path / "out" / "pump", Choices())


@pytest.fixture(scope="session")
def coulomb() -> Callable[..., Row]:
    """Makes the row of a machine with Coulomb friction of a level; of one where nothing is missing, where that is None."""

    def make(machine: str, level: float | None, *, month: int | None = None, std: float = 0.01, **more: Any) -> Row:
        parameters: dict[str, Any] = {"J": {"value": more.pop("J", 0.02), "std": None, "unit": "kg m^2"}}
        date = None if month is None else f"2026-{month:02d}-01"
        name = machine if date is None else f"{machine}/{date}"
        kept: dict[str, Any] = {"machine": machine, "recorded": date, "model": "Motor", "report": f"{name}/report.html"}
        kept |= {"confidence": 0.95, "fit_before": 80.0, "fit_after": 98.0, "seconds": 5.0}
        if level is None:
            return Row(name, "dataset.toml", "nothing", parameters=parameters, **kept | more)
        parameters["rotor.coulomb_friction.F_c"] = {"value": level, "std": std, "unit": "N m"}
        found = {"effect": "Coulomb friction at rotor", "port": "rotor", "mechanism": "coulomb_friction"}
        found |= {"parameter": "F_c", "unit": "N m", "sentence": "The mismatch is Coulomb friction at rotor."}
        numbers = {"probability": 0.9, "value": level, "std": std}
        return Row(name, "dataset.toml", "named", parameters=parameters, **kept | found | numbers | more)

    return make
