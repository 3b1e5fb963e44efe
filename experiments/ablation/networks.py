"""Which network the hybrid gets, and where: chosen by stretches of the estimation experiments, never by the validation experiments."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from greybox_torch import Coupling, DataSet, GreyBoxModel, TrainingSettings, UserError, train_hybrid
from greybox_torch.model import driving_body
from greybox_torch.training import Physics, Trained


@dataclass(frozen=True)
class NetworkChoice:
    """A network of ``kind`` friction or residual at a port, reading some of its signals."""

    kind: str
    port: str
    signals: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.kind}:{self.port}:{'+'.join(self.signals)}"

    @staticmethod
    def parsed(text: str) -> NetworkChoice:
        """From the form KIND:PORT:SIGNAL+SIGNAL. Raises UserError where it has another."""
        parts = text.split(":")
        if len(parts) != 3 or not all(parts):
            raise UserError(f"--networks {text}: expected KIND:PORT:SIGNAL+SIGNAL, such as friction:motor:speed")
        return NetworkChoice(parts[0], parts[1], tuple(parts[2].split("+")))

    def trained(self, data: DataSet, model: GreyBoxModel, physics: Physics, settings: TrainingSettings) -> Trained:
        """The hybrid with this network, its physics begun where the estimate ``physics`` of ``model`` is."""
        return train_hybrid(
            data, model, net=self.kind, port=self.port, signals=self.signals, settings=settings, physics=physics
        )


def usual_networks(model: GreyBoxModel) -> list[NetworkChoice]:
    """Friction and a residual at the driving body, a residual at every coupling."""
    found, body = [], driving_body(model.ports)
    if body is not None:
        both = ("speed", "load") if body.load is not None else ("speed",)
        found += [NetworkChoice("friction", body.name, ("speed",)), NetworkChoice("residual", body.name, both)]
    couplings = [port for port in model.ports if isinstance(port, Coupling)]
    found += [NetworkChoice("residual", port.name, ("deflection", "rate")) for port in couplings]
    if not found:
        raise UserError(f"model {model.title} has no body and no coupling; name networks with --networks")
    return found


def judged(choice: NetworkChoice, found: Trained) -> dict[str, Any]:
    """What the held-out stretches say: mean squared errors of the physics alone and of the best network."""
    alone, *others = found.polished.choices
    best = min((c.held_out for c in others), default=float("inf"))
    return {**asdict(choice), "physics": alone.held_out, "network": best, "share": best / alone.held_out}
