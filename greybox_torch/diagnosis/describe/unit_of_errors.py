"""In which unit the errors over windows are that hypotheses are compared by."""

from __future__ import annotations

from greybox_torch.diagnosis.study import Study


def unit_of_errors(study: Study) -> str:
    """In brackets, as the end of a sentence with such errors; nothing where the only output has no unit."""
    outputs = study.problem.model.outputs
    if len(outputs) > 1:
        return " (each output divided by the error of the model as it stands over the shortest windows)"
    unit = outputs[0].unit
    return f" ({unit})" if unit not in ("", "1") else ""
