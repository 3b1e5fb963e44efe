"""The command line: parses, and calls the command's `run`. Nothing else.

Modules that take long to import (torch, matplotlib, …) are imported by the commands when they run, so that `--help`
answers at once.
"""

from __future__ import annotations

import gc
from pathlib import Path
from typing import Annotated

import typer

from greybox_torch import __version__
from greybox_torch.commands import after_diagnosis, first_steps, many_machines
from greybox_torch.commands.exit_codes import Commands
from greybox_torch.commands.option_types import (
    Checkpoint,
    DataSetFile,
    Device,
    Json,
    Model,
    Out,
    Pdf,
    Precision,
    Seed,
    Settings,
    Starts,
    TimeLimit,
)
from greybox_torch.commands.options import Options

app = typer.Typer(
    cls=Commands,
    help="Find, name and model the physics that a simulation of a machine leaves out, from recordings of the real one.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(__version__)
        raise typer.Exit


@app.callback()
def greybox(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    pass


first_steps.declare(app)


@app.command()
def inspect(
    dataset: DataSetFile,
    model: Model = None,
    out: Out = None,
    seed: Seed = 0,
    device: Device = "cpu",
    json: Json = False,
) -> None:
    """Read and check the data, tabulate and plot every channel."""
    from greybox_torch.commands import inspect

    inspect.run(dataset, Options(model, out, seed, device, json))


@app.command()
def simulate(
    dataset: DataSetFile,
    checkpoint: Checkpoint = None,
    model: Model = None,
    out: Out = None,
    seed: Seed = 0,
    device: Device = "cpu",
    precision: Precision = "double",
    json: Json = False,
) -> None:
    """Simulate all experiments in free run with the card's parameter values, or the model of a checkpoint.

    Start states that the card does not fix are estimated from the first tenth of each experiment.
    """
    from greybox_torch.commands import simulate

    simulate.run(dataset, checkpoint, Options(model, out, seed, device, json, precision))


@app.command()
def fit(
    dataset: DataSetFile,
    profile: Annotated[
        list[str] | None,
        typer.Option(metavar="PARAMETER", help="Add its profile likelihood: 95 % interval, figure. Repeatable."),
    ] = None,
    starts: Starts = None,
    checkpoint: Checkpoint = None,
    model: Model = None,
    out: Out = None,
    seed: Seed = 0,
    device: Device = "cpu",
    precision: Precision = "double",
    json: Json = False,
) -> None:
    """Estimate the free parameters and initial states, and write them as a checkpoint."""
    from greybox_torch.commands import fit

    fit.run(dataset, Options(model, out, seed, device, json, precision), profile or [], starts, checkpoint)


@app.command()
def compare(
    dataset: DataSetFile,
    checkpoints: Annotated[
        list[Path] | None, typer.Argument(metavar="[CHECKPOINT]...", help="Results of fit, train or diagnose.")
    ] = None,
    model: Model = None,
    out: Out = None,
    seed: Seed = 0,
    device: Device = "cpu",
    precision: Precision = "double",
    json: Json = False,
) -> None:
    """Compare simulated with measured, for the start values and for checkpoints."""
    from greybox_torch.commands import compare

    compare.run(dataset, checkpoints or [], Options(model, out, seed, device, json, precision))


@app.command()
def residuals(
    dataset: DataSetFile,
    checkpoint: Checkpoint = None,
    model: Model = None,
    out: Out = None,
    seed: Seed = 0,
    device: Device = "cpu",
    precision: Precision = "double",
    json: Json = False,
) -> None:
    """Test prediction errors: are they white, and does the input still explain part of them?"""
    from greybox_torch.commands import residuals

    residuals.run(dataset, checkpoint, Options(model, out, seed, device, json, precision))


@app.command()
def diagnose(
    dataset: DataSetFile,
    time_limit: TimeLimit = None,
    settings: Settings = None,
    model: Model = None,
    out: Out = None,
    seed: Seed = 0,
    device: Device = "cpu",
    pdf: Pdf = False,
    json: Json = False,
) -> None:
    """Find the physics that is missing: where it acts, what it is, how sure that is, and the model with it."""
    from greybox_torch.commands import diagnose

    diagnose.run(dataset, time_limit, Options(model, out, seed, device, json), settings, pdf=pdf)


@app.command()
def train(
    dataset: DataSetFile,
    net: Annotated[
        str | None,
        typer.Option(
            metavar="friction|residual|memory",
            help="A body's friction, any extra force or flow at a port, or one with memory.",
            show_default="friction at a body, else residual",
        ),
    ] = None,
    port: Annotated[
        str | None, typer.Option(metavar="PORT", help="Where it acts.", show_default="first body, else first port")
    ] = None,
    signals: Annotated[
        str | None,
        typer.Option(metavar="A,B", help="Signals that it reads.", show_default="speed; deflection,rate; level; …"),
    ] = None,
    units: Annotated[int, typer.Option(min=1, max=256, help="Hidden units of the network.")] = 8,
    odd: Annotated[bool, typer.Option(help="The same friction in both directions.")] = True,
    dissipative: Annotated[bool, typer.Option(help="Friction that always opposes the motion.")] = True,
    memories: Annotated[int, typer.Option(min=1, max=4, help="Hidden states of a network with memory.")] = 1,
    gradient: Annotated[
        str,
        typer.Option(metavar="tangents|recomputation|odeint_adjoint", help="How gradients are computed."),
    ] = "tangents",
    epochs: Annotated[int, typer.Option(min=1, help="Most passes over the windows of each length.")] = 120,
    freeze_physics: Annotated[
        bool, typer.Option("--freeze-physics", help="Keep the physical parameters as estimated without the network.")
    ] = False,
    resume: Annotated[bool, typer.Option("--resume", help="Continue the interrupted training in DIR.")] = False,
    tensorboard: Annotated[bool, typer.Option("--tensorboard", help="Log the training to DIR/tensorboard.")] = False,
    explain: Annotated[
        bool, typer.Option(help="Compare what was learned with every law, and put the nearest in its place.")
    ] = True,
    ensemble: Annotated[
        int,
        typer.Option(min=1, metavar="N", help="Number of trainings, seeds from --seed on, for the curve's band."),
    ] = 1,
    model: Model = None,
    out: Out = None,
    seed: Seed = 0,
    device: Device = "cpu",
    json: Json = False,
) -> None:
    """Train a small network at a port of the model, for physics that has no name yet."""
    from greybox_torch.commands import train

    choices = train.Choices(
        net=net,
        port=port,
        signals=tuple(s.strip() for s in signals.split(",")) if signals else (),
        network={"units": units},
        by_net={"friction": {"odd": odd, "dissipative": dissipative}, "memory": {"memories": memories}},
        training={"epochs": epochs, "gradient": gradient, "freeze_physics": freeze_physics},
        resume=resume,
        tensorboard=tensorboard,
        explain=explain,
        ensemble=ensemble,
    )
    train.run(dataset, Options(model, out, seed, device, json), choices)


after_diagnosis.declare(app)
many_machines.declare(app)


def main() -> None:
    """The command `greybox`."""
    try:
        app()
    finally:
        gc.freeze()  # to look for circles among all that is left takes Python half a second, and the process ends anyway


if __name__ == "__main__":
    main()
