"""A model taken home: C, a module of torch, an FMU, or what its effects are in MJCF and URDF."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Literal, overload

from greybox_torch.api.arguments import check_model
from greybox_torch.api.data_argument import Data, check_data
from greybox_torch.api.export_result import ExportResult, SnippetResult
from greybox_torch.data import DataSet
from greybox_torch.errors import ArgumentError, UserError, did_you_mean
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.exporting.c_source import c_files
from greybox_torch.exporting.exported import ExportedModel, exported, identifier_of, step_without_data
from greybox_torch.exporting.fmu import fmu_files
from greybox_torch.exporting.joints.mjcf import mjcf
from greybox_torch.exporting.joints.snippet import Snippet
from greybox_torch.exporting.joints.urdf import urdf
from greybox_torch.exporting.torch_module import torch_files
from greybox_torch.mechanisms.attached import attached
from greybox_torch.model import GreyBoxModel

WRITERS: dict[str, Callable[[ExportedModel], Mapping[str, str | bytes]]] = {
    "c": c_files,
    "torch": torch_files,
    "fmu": fmu_files,
}
"""What a model can be exported to: functions that give the contents of files by name."""

SNIPPETS: dict[str, Callable[[GreyBoxModel, str], Snippet]] = {"mjcf": mjcf, "urdf": urdf}
"""What the effects of a model can be said in, for a simulation that has the rest of it already."""

KINDS = (*WRITERS, *SNIPPETS)


@overload
def export(
    model: GreyBoxModel | Any,
    to: Literal["mjcf", "urdf"],
    *,
    data: Data | None = None,
    name: str | None = None,
    step: float | None = None,
) -> SnippetResult: ...
@overload
def export(
    model: GreyBoxModel | Any,
    to: Literal["c", "torch", "fmu"],
    *,
    data: Data | None = None,
    name: str | None = None,
    step: float | None = None,
) -> ExportResult: ...
@overload
def export(
    model: GreyBoxModel | Any,
    to: str,
    *,
    data: Data | None = None,
    name: str | None = None,
    step: float | None = None,
) -> ExportResult | SnippetResult: ...
def export(
    model: GreyBoxModel | Any,
    to: str,
    *,
    data: Data | None = None,
    name: str | None = None,
    step: float | None = None,
) -> ExportResult | SnippetResult:
    """Export the model with its values and its effects, each with a switch, in a form that does not need this package.

    Args:
        model: an object, or the result of a fit or a diagnosis.
        to: "c" (a header, a source, an example), "torch" (a module), "fmu" (FMI 2.0 and 3.0, co-simulation);
            "mjcf" or "urdf" for the effects alone, to be added to a simulation of the machine that you already have:
            attributes of joints, tendons and actuators, and a list of what the format cannot express.
        data: recordings that set the integration step, and say how inputs change between samples; or their card by path.
        name: of functions and files; by default made from the model's.
        step: largest integration step in seconds; by default what ``data`` need, else the sample time that effects were found with.

    Raises:
        UserError: equations that have no compiled form, a dead time without a longest value, "mjcf" or "urdf" of a model without effects,
            or an argument is at fault.

    Examples:
        ``export(found, to="c", data=data).save("motor_in_c")``
    """
    check_kind(to)
    given = check_model(model)
    if to in SNIPPETS:
        if step is not None:
            raise ArgumentError(
                "step", step, f"{to} has attributes alone, the steps are its simulator's; expected none"
            )
        if not attached(given)[1]:
            raise UserError(
                f"{given.title} has no effects, so there is nothing to write as {to}, which is for effects alone; expected the results of "
                f"greybox diagnose that found some, or --to {', '.join(WRITERS)} for the model itself (in Python: to=)"
            )
        return SnippetResult(given, to, SNIPPETS[to](given, identifier_of(given, name)))
    hold = "zoh"
    if data is not None:
        data = check_data(data)
        hold = data.hold
        step = _needed(given, data) if step is None else step
    made = exported(given, name, step, hold)
    return ExportResult(
        given, to, made, dict(WRITERS[to](made)), "" if step is not None else step_without_data(given)[1]
    )


def check_kind(to: str) -> None:
    """Raises ArgumentError where a model cannot be exported ``to`` that."""
    if to not in KINDS:
        raise ArgumentError("to", to, f"expected one of {', '.join(KINDS)}{did_you_mean(str(to), KINDS)}")


def _needed(model: GreyBoxModel, data: DataSet) -> float:
    """The integration step, in seconds, that simulating ``data`` takes."""
    problem = make_problem(data, model, data.recordings)
    sample_time = min(recording.sample_time for recording in data.recordings)
    return sample_time / simulator_for(problem, tangents=False).substeps
