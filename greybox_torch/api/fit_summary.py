"""An estimate in words and tables."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from rich.console import Console
from rich.text import Text

from greybox_torch.api.estimated import EstimatedStart, estimated_parameters, estimated_starts
from greybox_torch.api.scores import print_substeps, squared_unit
from greybox_torch.estimate.brief_lists import brief_pairs, brief_sentences
from greybox_torch.estimate.far_starts import far_starts, told_far
from greybox_torch.estimate.fit import Estimation
from greybox_torch.estimate.notes import told_at_bound
from greybox_torch.estimate.profile import LEVEL, Profile
from greybox_torch.estimate.termination import Termination
from greybox_torch.model.own_weights import told_held
from greybox_torch.name_lists import brief
from greybox_torch.report.tables import number, print_table


def print_estimate(
    console: Console, found: Estimation, profiles: Mapping[str, Profile], given: Collection[str]
) -> None:
    """Parameters, start states, how the estimation ended, and profiles; ``given`` are the states that the card gives a start value."""
    console.print(Text("\nParameters", style="bold"))
    print_table(console, *parameter_table(found), prose=["description"])
    for e, name in enumerate(found.problem.records.names):
        console.print(Text(f"Initial states of {name}", style="bold"))
        print_table(console, *_initial_table(found, e), prose=["description"])
    for name, value in statistics(found).items():
        console.print(Text(f"{name + ':':24}{value}"), soft_wrap=True)
    print_substeps(console, found.substeps)
    _print_correlations(console, found)
    for line in warnings(found, given):
        console.print(Text(line, style="yellow"), soft_wrap=True)
    _print_profiles(console, profiles)


def statistics(found: Estimation) -> dict[str, str]:
    """How the estimation ended, in words."""
    unit = squared_unit(found.problem.model.outputs)
    fpe = f"{found.fpe:.6g}{unit}" if found.fpe < float("inf") else "undetermined: no more samples than unknowns"
    return {
        "termination": found.termination.value,
        "iterations": f"{found.iterations} (of the last descent)",
        "evaluations": str(found.evaluations),
        "mean squared error": f"{found.mse:.6g}{unit}",
        "final prediction error": fpe,
        "samples": str(found.samples),
    }


def parameter_table(found: Estimation) -> tuple[list[str], list[list[str | float]]]:
    """Headings and rows of the parameters."""
    known = found.uncertainty is not None
    rows: list[list[str | float]] = []
    for name, entry in estimated_parameters(found).items():
        bounds = f"[{number(entry.lower)}, {number(entry.upper)}]"
        rows.append([name, entry.description, entry.unit, *_numbers(entry, known), bounds, _kept(entry)])
    return _told(["name", "description", "unit", "value", "std", "std\n(coloured)", "bounds", ""], rows)


def _initial_table(found: Estimation, experiment: int) -> tuple[list[str], list[list[str | float]]]:
    rows: list[list[str | float]] = []
    states = {state.name: state for state in found.problem.model.states}
    for name, entry in estimated_starts(found, experiment).items():
        rows.append([name, states[name].description, entry.unit, *_numbers(entry, True), _kept(entry)])
    return _told(["name", "description", "unit", "value", "std", "std\n(coloured)", ""], rows)


def _told(headings: list[str], rows: list[list[str | float]]) -> tuple[list[str], list[list[str | float]]]:
    """Without the column of descriptions where the model gives none."""
    at = headings.index("description")
    if any(row[at] for row in rows):
        return headings, rows
    return [h for k, h in enumerate(headings) if k != at], [[v for k, v in enumerate(r) if k != at] for r in rows]


def _numbers(entry: EstimatedStart, known: bool) -> list[str | float]:
    """Value and deviations; none where the number is fixed."""
    deviations: list[str | float] = ["", ""]
    if known and not entry.fixed:
        deviations = [d if d < float("inf") else "undetermined" for d in (entry.std, entry.std_sandwich)]
    return [entry.value, *deviations]


def _kept(entry: EstimatedStart) -> str:
    return "fixed" if entry.fixed else "estimated"


def _print_correlations(console: Console, found: Estimation) -> None:
    pairs = found.correlation.strong_pairs() if found.correlation else []
    if pairs:
        console.print(Text(f"Estimates that move together (correlation): {brief_pairs(pairs)}"), soft_wrap=True)


def warnings(found: Estimation, given: Collection[str] = ()) -> list[str]:
    """What is doubtful about the estimate, in sentences; ``given`` are the states that the card gives a start value."""
    elsewhere = {name for one in found.identifiability if one.kind == "start" for name in one.parameters}  # told below
    lost = [
        n for n, deviation in found.parameter_deviations().items() if deviation == float("inf") and n not in elsewhere
    ]
    lines = [f"{told_at_bound(note.detail)}." for note in found.notes if note.kind is Termination.at_bound]
    if held := told_held(found.problem.model):
        lines.append(f"{held}.")
    if not found.problem.free.any():
        lines.append("All parameters are fixed, on the card or in the model: none is estimated.")
    if lost and all(one.kind != "numbers" for one in found.identifiability):
        lines.append(
            f"The data do not determine {brief(lost)}, alone or together: fix one of them, or excite the machine more."
        )
    lines += [f"{told}." for told in brief_sentences(found.identifiability)]
    far = far_starts(found.problem, given)
    return [*lines, f"{told_far(far)}."] if far else lines


def beginnings(found: Estimation) -> list[str]:
    """Where the free runs begin, where that is estimated: what a comparison of the same model does otherwise. A sentence, or none."""
    if not found.problem.initial_free.any():
        return []
    names = brief(found.problem.records.names)
    return [
        f"Refit of {names}: begun with the start states above, estimated on the whole experiment. All else, as in `greybox compare`: "
        "begun with start states estimated on the first tenth."
    ]


def _print_profiles(console: Console, profiles: Mapping[str, Profile]) -> None:
    if not profiles:
        return
    console.print(Text(f"Profile likelihood, {100 * LEVEL:g} % intervals", style="bold"))
    for one in profiles.values():
        console.print(Text(f"{one.sentence} (allowing for coloured residuals by {one.colour:.3g})"), soft_wrap=True)
