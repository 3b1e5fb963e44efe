"""A proof without a simulation and without the tool."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from experiments.concealed.proof import protocol
from experiments.verdicts.running import Outcome
from tests.concealed.proof.by_hand import ANSWERS, VERDICTS


@pytest.fixture
def by_hand(monkeypatch: pytest.MonkeyPatch) -> Callable[[], list[str]]:
    """Replace the generator and the tool; returns a function that tells which cases the tool was asked for so far."""
    asked: list[str] = []

    def draw_cases(planned: Any, seed: int, folder: Path, **_: Any) -> dict[str, dict[str, Any]]:
        for name in ANSWERS:
            (folder / name).mkdir(parents=True)
            (folder / name / "dataset.toml").write_text(f'name = "{name} {seed}"\n')
        return ANSWERS

    def diagnose(card: Path, out: Path, time_limit: float, *, threads: int) -> Outcome:
        name = card.parent.name
        asked.append(name)
        out.mkdir(parents=True, exist_ok=True)
        (out / "verdict.json").write_text(json.dumps(VERDICTS[name]))
        return Outcome(1.0, "said")

    monkeypatch.setattr(protocol, "draw_cases", draw_cases)
    monkeypatch.setattr("experiments.verdicts.running.diagnose", diagnose)
    return lambda: sorted(asked)
