"""The machines whose models are kept, and which networks are tried on each."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from greybox_torch.demo import DATASET

CHECKOUT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Network:
    """What `greybox train` is asked for."""

    kind: str
    port: str
    signals: str

    @property
    def options(self) -> list[str]:
        """As options of the command."""
        return ["--net", self.kind, "--port", self.port, "--signals", self.signals]

    @property
    def folder(self) -> str:
        return f"hybrid_{self.kind}_{self.port}_{self.signals.replace(',', '_')}"

    def __str__(self) -> str:
        return f"{self.kind} network at `{self.port}` over {self.signals.replace(',', ', ')}"


@dataclass(frozen=True)
class Machine:
    """``name`` is the folder of its checkpoints; ``networks`` are tried in turn, the held-out stretches choose among them."""

    name: str
    card: Path
    networks: tuple[Network, ...]


MACHINES = (
    Machine(
        "demo",
        DATASET,
        (Network("friction", "motor", "speed"), Network("residual", "gear_spring", "deflection")),
    ),
    Machine(
        "robot_arm",
        CHECKOUT / "experiments" / "recordings" / "robot_arm_all_free.toml",
        (
            Network("friction", "motor", "speed"),
            Network("friction", "gearbox", "speed"),
            Network("residual", "gear_spring", "deflection,rate"),
            Network("friction", "motor", "speed,load"),
            Network("residual", "motor", "speed,load"),
            Network("residual", "arm_spring", "deflection,rate"),
        ),
    ),
)
