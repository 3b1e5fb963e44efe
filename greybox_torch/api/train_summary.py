"""A training on the console."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.text import Text

from greybox_torch.api.scores import Scores, print_scores, print_substeps, squared_unit
from greybox_torch.api.train_explained import print_explanation
from greybox_torch.api.train_held_out import lost_choices, mostly_lost
from greybox_torch.data import DataSet
from greybox_torch.estimate.initial import BEGINNINGS
from greybox_torch.model import GreyBoxModel
from greybox_torch.report.tables import print_table
from greybox_torch.training import Explanation, Trained

LOST = "ran away"
MOST_LOST = (
    "Most of these free runs ran away, with the physics alone as well: their errors say hardly anything of what the network has learned. "
    "Run `greybox diagnose` first, and train beside the model that it recommends."
)

REFIT = f"refit: the physics alone, estimated on whole records with each output weighed by its spread. {BEGINNINGS}"


def print_training(
    console: Console,
    data: DataSet,
    model: GreyBoxModel,
    found: Trained,
    scores: Scores,
    explained: Explanation | None,
    advice: Sequence[str] = (),
) -> None:
    """What the network is and what it adds, how the physics moved, fit and error of every experiment before and after, and ``advice``."""
    network = found.hybrid.network
    console.print(Text(f"{data.name}: {model.title}", style="bold"))
    console.print(Text(f"\n{training_sentence(found)}", style="bold"), soft_wrap=True)
    shown = {k: v for k, v in network.mechanism.options().items() if k != "inputs"}
    options = "; ".join(
        [
            f"inputs {', '.join(found.hybrid.told(network.mechanism.needs))}",
            *(f"{k} {_told(v)}" for k, v in shown.items()),
        ]
    )
    console.print(Text(f"{network.mechanism.name} at {network.port}: {options}"), soft_wrap=True)
    columns, rows = parameter_table(found)
    print_table(console, columns, rows, prose=["description"])
    _print_choices(console, found)
    if explained is not None:
        print_explanation(console, explained, scores, adds=found.hybrid.adds, judged=not mostly_lost(found))
    print_substeps(console, found.result.substeps)
    console.print()
    print_scores(console, data, scores)
    console.print(Text(REFIT), soft_wrap=True)
    for line in advice:
        console.print(Text(line, style="yellow"), soft_wrap=True)
    console.print(Text(f"training took {found.seconds:.1f} s, {len(found.history)} epochs, seed {found.settings.seed}"))


def training_sentence(found: Trained) -> str:
    """What the network adds to the physics."""
    network = found.hybrid.network
    if found.physics_chosen:
        return f"A network at {network.port} predicts the held-out stretches no better than the physics alone: it is left at zero."
    return (
        f"With a network at {network.port} the mean squared error of the estimation experiments falls from "
        f"{found.physics.mse:.4g} to {found.result.mse:.4g}{squared_unit(found.result.problem.model.outputs)}."
    )


def _told(value: object) -> str:
    if isinstance(value, tuple):
        return "/".join(map(str, value))
    return {True: "yes", False: "no"}.get(value, str(value)) if isinstance(value, bool) else str(value)


def parameter_table(found: Trained) -> tuple[list[str], list[list[str | float]]]:
    """Headings and rows of the physical parameters, alone and beside the network."""
    physics, hybrid = found.physics.problem, found.result.problem
    rows: list[list[str | float]] = []
    for k, declared in enumerate(physics.model.declared_parameters):
        kept = "estimated" if hybrid.free[k] else "fixed"
        numbers = [float(physics.values[k]), float(hybrid.values[k])]
        rows.append([declared.name, declared.description, declared.unit, *numbers, kept])
    return ["name", "description", "unit", "physics\nalone", "beside the\nnetwork", ""], rows


def choice_rows(found: Trained) -> list[list[str | float]]:
    """Every penalty and the physics alone, with its mean squared error on the held-out stretches."""
    rows: list[list[str | float]] = []
    for choice, lost in zip(found.polished.choices, lost_choices(found), strict=True):
        name = "physics alone" if choice.weight is None else f"penalty {choice.weight:g}"
        rows.append([name, choice.held_out, "chosen" if choice is found.polished.chosen else LOST if lost else ""])
    return rows


def _print_choices(console: Console, found: Trained) -> None:
    unit = squared_unit(found.result.problem.model.outputs)
    print_table(
        console,
        ["free run on the held-out stretches", f"mean squared error\n{unit.strip()}".strip(), ""],
        choice_rows(found),
    )
    if mostly_lost(found):
        console.print(Text(MOST_LOST, style="yellow"), soft_wrap=True)
    elif told := penalty_at_an_end(found):
        console.print(Text(told), soft_wrap=True)


def penalty_at_an_end(found: Trained) -> str:
    """A sentence where the chosen penalty is the least or the largest that was tried; "" elsewhere."""
    polished = found.polished
    if not (end := polished.at_an_end):
        return ""
    if end == "largest":
        larger = f"from Python, `gt.TrainingSettings(penalty={10.0 * found.settings.penalty:g})`"
        return f"The chosen penalty is the largest that was tried: a larger one may predict as well ({larger})."
    lower = f"from Python, `gt.TrainingSettings(penalty={0.1 * found.settings.penalty:g})` begins there"
    return f"The chosen penalty is the least that was tried: a lower one may predict better ({lower})."
