"""The cases that are diagnosed, the same each time."""

from __future__ import annotations

from pathlib import Path

from experiments.speed.settings import ALL_FREE_CARD, CHECKOUT, SHARED

DEMO = "demo"
ARM = "real arm, all but J free"
PENDULUM = "double pendulum, recorded"


def cases() -> dict[str, Path]:
    """Cards by the name of the case: the demo, and, where ../shared is there, the development cases and two recordings."""
    development = sorted((SHARED / "concealed" / "dev").glob("d*/dataset.toml"))
    found = {DEMO: CHECKOUT / "greybox_torch" / "demo" / "dataset.toml"} | {
        card.parent.name: card for card in development
    }
    if (SHARED / "recordings" / "robot_arm" / "RobotArm.mat").exists():
        found[ARM] = ALL_FREE_CARD
    pendulum = SHARED / "recordings" / "elsewhere" / "double_pendulum" / "dataset.toml"
    return found | ({PENDULUM: pendulum} if pendulum.exists() else {})


def development_cases(names: list[str]) -> list[str]:
    """Those of ``names`` that are development cases."""
    return [name for name in names if name not in (DEMO, ARM, PENDULUM)]
