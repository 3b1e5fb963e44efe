"""`greybox train`: the hybrid of a physical model and a network at one of its ports."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from greybox_torch.api.train import train
from greybox_torch.commands.options import Options
from greybox_torch.commands.progress import training
from greybox_torch.commands.results_folder import NOTHING_WRITTEN, nothing_written
from greybox_torch.commands.task import load_task
from greybox_torch.training import Report, TrainingSettings
from greybox_torch.training.hybrid import chosen_net, network_at
from greybox_torch.training.tensorboard import tensorboard_log

SNAPSHOT, LOG = "training.safetensors", "tensorboard"


@dataclass(frozen=True)
class Choices:
    """What the user asked for: which network reads which signals at which port, and how it is trained.

    ``network`` are options of every network, ``by_net`` those of one alone.
    """

    net: str | None = None
    port: str | None = None
    signals: Sequence[str] = ()
    network: Mapping[str, Any] = field(default_factory=dict)
    by_net: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    training: Mapping[str, Any] = field(default_factory=dict)
    resume: bool = False
    tensorboard: bool = False
    explain: bool = True
    ensemble: int = 1


def run(dataset: Path, options: Options, choices: Choices) -> None:
    """Trains, and writes train.json, the checkpoint `model`, what was learned as a figure, and the model with a law instead as `named`.

    While it runs it keeps `training.safetensors`, which --resume takes up; that is left where it is.
    """
    with nothing_written():
        task = load_task(dataset, options, writes_model="train")
    settings = TrainingSettings(seed=options.seed, **choices.training)
    # refused before anything is said to be done
    net = chosen_net(task.model, choices.net, choices.port)
    network = {**choices.network, **choices.by_net.get(net, {})}
    network_at(task.model, net, choices.port, choices.signals, **network)
    with ExitStack() as together:
        together.enter_context(_interruptible(task.folder / SNAPSHOT, choices.resume))
        log = together.enter_context(tensorboard_log(task.folder / LOG)) if choices.tensorboard else None
        tell = together.enter_context(training(f"training a hybrid of {task.data.name}"))

        def progress(report: Report) -> None:
            tell(report.stage, report.share, report.line)
            if log is not None and report.last is not None:
                log(report.last)

        found = train(
            task.model,
            task.data,
            net=net,
            port=choices.port,
            signals=choices.signals,
            network=network,
            settings=settings,
            explain=choices.explain,
            ensemble=choices.ensemble,
            device=task.device,
            snapshot=task.folder / SNAPSHOT,
            resume=choices.resume,
            progress=task.replacing.before(progress),
        )
    task.replacing.warn()
    kept = [task.folder / SNAPSHOT] if (task.folder / SNAPSHOT).is_file() else []
    options.finish(found, task.folder, [*found.save(task.folder), *kept])


@contextmanager
def _interruptible(snapshot: Path, resumed: bool) -> Iterator[None]:
    """What Ctrl-C says in the block: how to go on, or, where no epoch is kept yet, that nothing is written."""
    before = _written(snapshot)
    try:
        yield
    except KeyboardInterrupt:
        now = _written(snapshot)
        kept = now is not None and (resumed or now != before)  # else it is of an earlier training
        on = (
            f"the same command with --resume goes on from {snapshot}, which has the epochs on windows; Gauss-Newton and what follows are "
            "done again"
        )
        raise KeyboardInterrupt(on if kept else NOTHING_WRITTEN) from None


def _written(file: Path) -> int | None:
    """When a file was last written, ns; None where there is none."""
    return file.stat().st_mtime_ns if file.is_file() else None
