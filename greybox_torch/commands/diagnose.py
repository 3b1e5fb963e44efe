"""`greybox diagnose`: whether physics is missing, where, what it is, and the model with it."""

from __future__ import annotations

import shlex
from datetime import datetime
from pathlib import Path

from greybox_torch import __version__
from greybox_torch.checkpoint import Checkpoint, checkpoint_files
from greybox_torch.commands.options import Options
from greybox_torch.commands.progress import stages
from greybox_torch.commands.task import Task, check_estimation, load_task
from greybox_torch.commands.verdict_summary import print_verdict
from greybox_torch.diagnosis.pipeline import Diagnosis, diagnose
from greybox_torch.files import json_text, write_all
from greybox_torch.report.about import About
from greybox_torch.report.page import render_page

VERDICT, REPORT, MODEL = "verdict.json", "report.html", "model"


def run(dataset: Path, time_limit: float | None, options: Options) -> None:
    """Diagnoses, writes the verdict, the report and the augmented model (all or nothing), and prints what was found.

    Raises UserError where the input is at fault, NumericalError where even short stretches of the simulation overflow.
    """
    task = load_task(dataset, options)
    check_estimation(dataset, task.data)
    with stages(f"diagnosing {task.data.name}") as progress:
        found = diagnose(
            task.data, task.model, seed=options.seed, device=task.device, time_limit=time_limit, progress=progress
        )
        progress("writing the report")
        verdict = {**found.verdict.as_json(), "held_out_by_default": task.data.held_out_by_default}
        write_all(
            {
                task.folder / VERDICT: json_text(verdict),
                task.folder / REPORT: render_page(found.verdict, _about(dataset, task, found)),
                **checkpoint_files(task.folder / MODEL, _checkpoint(task, found)),
            }
        )
    print_verdict(options.console(), task, found.verdict)
    options.print_json(verdict)


def _units(found: Diagnosis) -> dict[str, str]:
    return {p.name: p.unit for p in found.model.declared_parameters}


def _checkpoint(task: Task, found: Diagnosis) -> Checkpoint:
    return Checkpoint(
        model=task.model_name,
        title=task.model.title,
        values=found.values,
        units=_units(found),
        effects=found.attachments,
        free_starts=True,
        dataset=task.data.sha256,
        figures=found.verdict.as_json()["fit"],
    )


def _about(dataset: Path, task: Task, found: Diagnosis) -> About:
    model = ["--model", task.model_name] if task.data.model is None else []
    return About(
        version=__version__,
        created=datetime.now().astimezone(),
        device=task.device,
        held_out_by_default=task.data.held_out_by_default,
        values=found.values,
        units=_units(found),
        command=shlex.join(["greybox", "compare", str(dataset), str(task.folder / MODEL), *model]),
    )
