"""Finding the physics that a model leaves out."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from greybox_torch.api.arguments import check_estimation, check_model, check_moving
from greybox_torch.api.asked_of_channels import asked_where_poor, poor
from greybox_torch.api.data_argument import Data, check_data
from greybox_torch.api.diagnosis_result import DiagnosisResult
from greybox_torch.api.plain_arguments import check_device, check_kind, check_seconds, check_seed, check_told
from greybox_torch.api.short_refits import Asked
from greybox_torch.codegen.build import check_compiler
from greybox_torch.data import DataSet
from greybox_torch.deadline import Deadline, until
from greybox_torch.diagnosis import pipeline
from greybox_torch.diagnosis.beliefs import beliefs_from_mapping
from greybox_torch.diagnosis.progress import Progress
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget, settings_from_mapping
from greybox_torch.diagnosis.slip_first import looks_like_a_slip, ports_of, with_question
from greybox_torch.diagnosis.stopping import or_else
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.keywords import names_checked
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.simulator import SimulationOptions, Simulator

TO_ASK, TO_ASK_SHARE = 3.0, 0.05
"""Seconds, and share of a time limit, that the question whether channels are exchanged may take beyond it: the larger of the two."""


@names_checked
def diagnose(
    model: GreyBoxModel | Any,
    data: Data,
    *,
    time_limit: float | None = None,
    settings: DiagnosisSettings | None = None,
    budget: SearchBudget | None = None,
    beliefs: Mapping[str, float | str] | None = None,
    seed: int = 0,
    device: str = "cpu",
    progress: Callable[[str], None] = lambda text: None,
    on_progress: Callable[[Progress], None] = lambda progress: None,
) -> DiagnosisResult:
    """Find what physics the model leaves out: whether, where it acts, what it is, how sure that is, and the model with it.

    Choosing uses the experiments of role "estimation". Those of role "validation" judge: they can take a finding back.
    One of them is used for choosing too where it shows what the others do not; the report says so.

    Args:
        model: searched from the values that it holds: those set by ``set_values()``, else the start values of the data set's card, else the
            declared ones. It stays as it is; the result's ``model`` is a copy with the effects that were found.
        data: the experiments, from :func:`greybox_torch.load_dataset` or made with ``DataSet(…)``; or their card by path.
        time_limit: seconds after which the best answer so far is given, with a list of what was not tried. Only two
            steps may take longer, as no answer is possible without them: the fit of the model as it stands, and the
            comparison of the result with all experiments. Where the model found is poor, a few short refits ask besides, within
            the larger of 3 s and 5 % of it, whether channels are exchanged or turned.
        settings: the thresholds of its decisions; by default those of the card's table [diagnosis], else the defaults.
        budget: how much it may compute; by default likewise.
        beliefs: what is known beforehand, by "port/mechanism" (* for any): "likely", "unlikely", or a probability; 0 takes a hypothesis out
            of the search. By default what the card's table [beliefs] says.
        seed: kept in the verdict; the search itself draws no random numbers.
        device: "cpu", "cuda" or "cuda:N".
        progress: is told what is being done, in words.
        on_progress: is told where the diagnosis stands whenever that changes: a :class:`Progress` with the seconds, what is being done, and
            the leading finding. It is called from several threads; what it raises ends the diagnosis.

    Raises:
        UserError: there is no C++ compiler (the installation extra ``compiler`` brings one), model and data do not fit, there is no
            experiment to choose with, no output moves, or an argument is at fault.
        NumericalError: even short stretches of the simulation overflow.

    Examples:
        ``print(diagnose(Motor(), data, time_limit=60, on_progress=lambda now: print(now.leading)).sentence)``
    """
    given, device = check_model(model), check_device(device)
    limit = None if time_limit is None else check_seconds("time_limit", time_limit)
    check_told("progress", progress)
    check_told("on_progress", on_progress, "a Progress")
    data = check_data(data)
    check_estimation(data)
    if device == "cpu":
        check_compiler("a diagnosis")
    make_problem(data, given, data.recordings)  # all of them fit the model, whatever the search takes first
    check_moving(data, given)
    believed = (data.beliefs, data.place("[beliefs]")) if beliefs is None else (beliefs, "argument beliefs")
    own = settings_from_mapping(data.diagnosis, data.place("[diagnosis]"))
    to_ask = Deadline.after(None if limit is None else limit + max(TO_ASK, TO_ASK_SHARE * limit))
    found = pipeline.diagnose(
        data,
        given,
        seed=check_seed(seed),
        device=device,
        time_limit=limit,
        settings=own[0] if settings is None else check_kind("settings", settings, DiagnosisSettings),
        budget=own[1] if budget is None else check_kind("budget", budget, SearchBudget),
        beliefs=beliefs_from_mapping(believed[0], given, believed[1]),
        progress=progress,
        on_progress=on_progress,
    )
    return DiagnosisResult(data, given, _with_question(found, data, given, device, progress, to_ask), device)


def _with_question(
    found: pipeline.Diagnosis,
    data: DataSet,
    model: GreyBoxModel,
    device: str,
    progress: Callable[[str], None],
    deadline: Deadline,
) -> pipeline.Diagnosis:
    """The findings with the question of a fit, whether channels are exchanged or turned; Ctrl-C, or the deadline, leaves it out.

    Asked where what was found explains little, or is what such a channel would look like, or where parameters of the model end at a bound
    beside it; what was found is doubtful where the channel explains far more. Seen: a heater's input of the other sign, told as an unknown
    effect at its actuator (0.97, validation 98 %).
    """
    began, verdict = time.perf_counter(), found.verdict
    as_a_slip = any(looks_like_a_slip(e) for e in verdict.effects)
    good_so = bool(verdict.effects) and not as_a_slip and not poor(verdict.scores["augmented"])
    if not poor(verdict.scores["refit"]) or (good_so and not _may_make_up(verdict)):
        return found

    def simulator() -> Simulator:
        return simulator_for(make_problem(data, model, data.estimation()), SimulationOptions(device))

    def asked() -> Asked | None:
        with until(deadline):
            return asked_where_poor(data, model, verdict.scores["refit"], simulator, progress)

    slip, _ = or_else(asked, lambda: None)
    told = verdict
    if slip is not None:
        told = with_question(verdict, slip.question, slip.reaches, slip.lead, ports_of(model, slip.channels))
    if good_so and not told.question_first:  # beside a good answer only what is far better is worth a question
        told = verdict
    return replace(found, verdict=replace(told, seconds=verdict.seconds + time.perf_counter() - began))


def _may_make_up(verdict: Verdict) -> bool:
    """Whether effects that explain much may make up for a slip: a parameter of the model ended at a bound beside them, but not at zero,
    which is a limit of physics, and more than noise is left.

    Seen: rpm read as rad/s, told as friction at the wrong body (98.3 %), with a carriage of 0.1 kg at its bound.
    """
    if verdict.left is not None and verdict.left.times_noise < verdict.settings.above_noise:
        return False
    return any(e.at_bound[1] and e.augmented and e.augmented[0] != 0.0 for e in verdict.parameters)
