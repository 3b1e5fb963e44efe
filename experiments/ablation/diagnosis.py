"""The diagnosis of a case: an earlier one, or one made now by the command line, as a user would."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments.verdicts.running import diagnose
from greybox_torch import Checkpoint, DataSet, GreyBoxModel, NumericalError, UserError, load_checkpoint
from greybox_torch.mechanisms import AugmentedModel, restored_model


@dataclass(frozen=True)
class Diagnosed:
    """What a diagnosis said in one sentence, how long it took in s, and its checkpoint."""

    sentence: str
    seconds: float
    checkpoint: Checkpoint

    @property
    def has_curve(self) -> bool:
        """Whether one of its effects is a free curve rather than a law."""
        return any(e["mechanism"] == "unknown" for e in self.checkpoint.effects)

    def model(self, base: GreyBoxModel, *, named_only: bool) -> GreyBoxModel | None:
        """``base`` with the effects found, perhaps with the laws among them alone; None where there are none."""
        effects = [e for e in self.checkpoint.effects if not (named_only and e["mechanism"] == "unknown")]
        return restored_model(base, effects) if effects else None

    def values(self, model: GreyBoxModel) -> dict[str, float]:
        """Its values of the parameters that ``model`` has."""
        return {p.name: self.checkpoint.values[p.name] for p in model.declared_parameters}

    def laws(self, base: GreyBoxModel) -> list[str]:
        """The laws found, each with its port."""
        model = self.model(base, named_only=True)
        return [a.prefix for a in model.attachments] if isinstance(model, AugmentedModel) else []


def diagnosis(data: DataSet, folder: Path, given: Path | None, time_limit: float | None) -> Diagnosed:
    """The diagnosis in ``given``, or else in ``folder``, which is filled by `greybox diagnose` where it is empty.

    Raises:
        UserError: the diagnosis given is of other data, or is none.
        NumericalError: the diagnosis failed.
    """
    place = given or folder
    if given is None and not (folder / "verdict.json").is_file():
        outcome = diagnose(Path(data.path), folder, time_limit)
        if outcome.failure:
            raise NumericalError(f"diagnosing {data.path} failed: {outcome.failure}")
    try:
        verdict: dict[str, Any] = json.loads((place / "verdict.json").read_text(encoding="utf-8"))
        sentence, seconds = str(verdict["sentence"]), float(verdict["seconds"])
    except (OSError, json.JSONDecodeError, KeyError) as error:
        raise UserError(f"{place / 'verdict.json'}: {error}; expected what `greybox diagnose` has written") from None
    checkpoint = load_checkpoint(place / "model")
    if checkpoint.dataset != data.sha256:
        raise UserError(f"{place}: a diagnosis of other samples than those of {data.path}; expected one of the same")
    return Diagnosed(sentence, seconds, checkpoint)
