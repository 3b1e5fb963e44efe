"""Training a network at a port of a model, for physics that has no name yet."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

from greybox_torch.api.arguments import check_estimation, check_model, check_moving
from greybox_torch.api.data_argument import Data, check_data
from greybox_torch.api.plain_arguments import check_device, check_kind, check_names, check_told, check_whole
from greybox_torch.api.train_range import beyond_learned
from greybox_torch.api.train_result import TrainingResult
from greybox_torch.api.train_scores import HYBRID, free_runs_of
from greybox_torch.errors import ArgumentError
from greybox_torch.estimate.problem import make_problem
from greybox_torch.keywords import names_checked
from greybox_torch.model import GreyBoxModel
from greybox_torch.training import Explanation, Report, Trained, TrainingSettings, train_hybrid
from greybox_torch.training import explain as explain_network

MOST_MEMBERS = 1000


@names_checked
def train(
    model: GreyBoxModel | Any,
    data: Data,
    *,
    net: str | None = None,
    port: str | None = None,
    signals: Iterable[str] = (),
    network: Mapping[str, Any] | None = None,
    settings: TrainingSettings = TrainingSettings(),
    explain: bool = True,
    ensemble: int = 1,
    device: str = "cpu",
    snapshot: str | PathLike[str] | None = None,
    resume: bool = False,
    progress: Callable[[Report], None] = lambda report: None,
) -> TrainingResult:
    """Attach a small network to a port, train it on the experiments of role "estimation", say what it has learned, and
    score everything.

    Args:
        model: the physics, estimated first, from the values that it holds: those set by ``set_values()``, else the start values of the data
            set's card, else the declared ones. It stays as it is; the result's ``model`` is a copy with the trained network.
        data: the experiments, from :func:`greybox_torch.load_dataset` or made with ``DataSet(…)``; or their card by path.
        net: "friction" (a body's speed, and what else is asked for) or "residual" (any signals at any port), or "memory" (the
            same with hidden states). By default friction at a body, else residual.
        port: where it acts; by default the first body that the model declares, and the first port of a model without bodies.
        signals: what it reads, by their names at the port or by those of the model's states and inputs; by default the usual ones of such
            a port.
        network: further arguments of :class:`FrictionNet`, :class:`ResidualNet` or :class:`MemoryNet`: units, odd, dissipative, memories.
        settings: of the training, its seed among them.
        explain: compare what was learned with every law of the library, and put the nearest in the network's place.
        ensemble: how many trainings, with seeds from that of the settings on, the band of the learned curve comes from.
        device: "cpu", "cuda" or "cuda:N".
        snapshot: a file, kept up to date while the training runs, from which it can be continued; none by default.
        resume: continue the training from there.
        progress: is told what is being done, and of every epoch.

    Raises:
        UserError: model and data do not fit, there is no experiment to train on, no such port, network or signal, the recordings are too
            short, the snapshot is not of this training, or an argument is at fault.
        NumericalError: even short stretches of the simulation overflow.

    Examples:
        ``gt.train(Motor(), data, net="residual", port="actuator").explanation.sentence``
    """
    given, device = check_model(model), check_device(device)
    check_told("progress", progress, "a Report")
    data = check_data(data)
    check_estimation(data)
    check_kind("settings", settings, TrainingSettings)
    count = check_whole("ensemble", ensemble, 1, MOST_MEMBERS)
    if resume and snapshot is None:
        raise ArgumentError("resume", True, "expected a snapshot to take the training up from")
    make_problem(data, given, data.recordings)  # all of them fit the model, whatever is trained on
    check_moving(data, given)
    trained = partial(
        train_hybrid,
        data,
        given,
        net=net,
        port=port,
        signals=check_names("signals", signals),
        network=dict(network or {}),
        device=device,
        progress=progress,
    )
    found = trained(settings=settings, snapshot=None if snapshot is None else Path(snapshot), resume=resume)
    explanation = _explained(found, trained, count, progress) if explain else None
    progress(Report("scoring", 1.0))
    runs = free_runs_of(data, given, found, explanation, device)
    return TrainingResult(data, given, found, explanation, runs, beyond_learned(data, given, found, runs[HYBRID]))


def _explained(
    found: Trained, trained: Callable[..., Trained], members: int, progress: Callable[[Report], None]
) -> Explanation:
    """What the network stands for; the trainings of an ensemble share the physics."""
    others = []
    for seed in range(found.settings.seed + 1, found.settings.seed + members):
        progress(Report(f"training with seed {seed}", 1.0))
        others.append(trained(settings=replace(found.settings, seed=seed), physics=found.shared_physics))
    return explain_network(found, others, told=lambda what: progress(Report(what, 1.0)))
