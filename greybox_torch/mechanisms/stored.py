"""Attachments as JSON, and the augmented model back from it."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from greybox_torch.errors import UserError
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.library import BUILT_IN, LEARNED, LIBRARY
from greybox_torch.mechanisms.mechanism import Mechanism, Range, Surroundings
from greybox_torch.model import GreyBoxModel


def attachment_json(attachment: Attachment, around: Surroundings) -> dict[str, Any]:
    """Everything needed to attach the same mechanism again."""
    mechanism = attachment.mechanism
    file = _defined_in(mechanism)
    return {
        "port": attachment.port,
        "mechanism": mechanism.name,
        "options": mechanism.options(),
        **({"defined_in": file} if file else {}),
        "label": attachment.label,
        "position": attachment.position,
        "shifted_state": attachment.shifted_state,
        **({"substeps": attachment.substeps} if attachment.substeps > 1 else {}),
        "surroundings": {
            "ranges": {name: asdict(r) for name, r in around.ranges.items()},
            "unmeasured": sorted(around.unmeasured),
            "units": dict(around.units),
            "force_unit": around.force_unit,
            "sample_time": around.sample_time,
        },
    }


def stored_effects(model: GreyBoxModel) -> list[dict[str, Any]]:
    """What is attached to ``model``, in the form that a checkpoint keeps; empty for a plain model."""
    if not isinstance(model, AugmentedModel):
        return []
    own = [attachment_json(a, model.surroundings[a.port]) for a in model.attachments]
    return in_layers(stored_effects(model.base), own)


def in_layers(there: Sequence[Mapping[str, Any]], further: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Effects that a model has, and those that were attached to it with these in it.

    Which of them act first, and what they know of their ports, depends on what was attached to what: a ``layer`` tells.
    """
    layer = max((_layer(entry) for entry in there), default=-1) + 1
    return [*(dict(e) for e in there), *({**e, "layer": layer} if layer else dict(e) for e in further)]


def _layer(entry: Mapping[str, Any]) -> int:
    return int(entry.get("layer", 0))


def restored_model(base: GreyBoxModel, attachments: Sequence[Mapping[str, Any]]) -> GreyBoxModel:
    """``base`` with the effects of a checkpoint attached.

    Raises:
        UserError: a mechanism that is not in the library, or a port that the model does not have.
    """
    model = base
    for layer in sorted({_layer(entry) for entry in attachments}):
        model = _with_layer(model, [entry for entry in attachments if _layer(entry) == layer])
    return model


def _with_layer(base: GreyBoxModel, attachments: Sequence[Mapping[str, Any]]) -> AugmentedModel:
    restored, surroundings = [], {}
    for entry in attachments:
        restored.append(
            Attachment(
                entry["port"],
                _mechanism(str(entry["mechanism"]), entry["options"], str(entry.get("defined_in", ""))),
                label=entry.get("label", ""),
                position=entry["position"],
                shifted_state=entry["shifted_state"],
                substeps=int(entry.get("substeps", 1)),
            )
        )
        around = entry["surroundings"]
        ranges = {name: Range(**values) for name, values in around["ranges"].items()}
        surroundings[entry["port"]] = Surroundings(
            ranges,
            around["units"],
            around["force_unit"],
            around["sample_time"],
            frozenset(around.get("unmeasured", ())),
        )
    return AugmentedModel(base, restored, surroundings)


def _mechanism(name: str, options: Mapping[str, Any], defined_in: str) -> Mechanism:
    known = {**LIBRARY, **LEARNED}
    if name not in known:
        raise UserError(
            f"mechanism '{name}' is not in the library; expected one of {', '.join(known)}, or that {_definition(defined_in)} "
            f"was run before, for example by putting it into the model's file"
        )
    try:
        return known[name](**options)
    except TypeError as error:
        raise TypeError(f"{known[name].__name__}: {error}") from None  # the constructor may be another class's


def _definition(file: str) -> str:
    return f"{file}, which registered it," if file else "the file that registers it"


def _defined_in(mechanism: Mechanism) -> str:
    """The file of a mechanism that is not the package's, without its folder."""
    module = sys.modules.get(type(mechanism).__module__)
    return Path(getattr(module, "__file__", None) or "").name if mechanism.name not in {*BUILT_IN, *LEARNED} else ""
