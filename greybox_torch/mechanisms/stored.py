"""Attachments as JSON, and the augmented model back from it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from greybox_torch.errors import UserError
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.library import LEARNED, LIBRARY
from greybox_torch.mechanisms.mechanism import Mechanism, Range, Surroundings
from greybox_torch.model import GreyBoxModel


def attachment_json(attachment: Attachment, around: Surroundings) -> dict[str, Any]:
    """Everything needed to attach the same mechanism again."""
    mechanism = attachment.mechanism
    return {
        "port": attachment.port,
        "mechanism": mechanism.name,
        "options": mechanism.options(),
        "position": attachment.position,
        "shifted_state": attachment.shifted_state,
        "surroundings": {
            "ranges": {name: asdict(r) for name, r in around.ranges.items()},
            "units": dict(around.units),
            "force_unit": around.force_unit,
            "sample_time": around.sample_time,
        },
    }


def restored_model(base: GreyBoxModel, attachments: Sequence[Mapping[str, Any]]) -> AugmentedModel:
    """``base`` with the effects of a checkpoint attached.

    Raises:
        UserError: a mechanism that is not in the library, or a port that the model does not have.
    """
    restored, surroundings = [], {}
    for entry in attachments:
        restored.append(
            Attachment(
                entry["port"],
                _mechanism(str(entry["mechanism"]), entry["options"]),
                position=entry["position"],
                shifted_state=entry["shifted_state"],
            )
        )
        around = entry["surroundings"]
        ranges = {name: Range(**values) for name, values in around["ranges"].items()}
        surroundings[entry["port"]] = Surroundings(ranges, around["units"], around["force_unit"], around["sample_time"])
    return AugmentedModel(base, restored, surroundings)


def _mechanism(name: str, options: Mapping[str, Any]) -> Mechanism:
    known = {**LIBRARY, **LEARNED}
    if name not in known:
        raise UserError(f"mechanism '{name}' is not in the library; expected one of {', '.join(known)}")
    return known[name](**options)
