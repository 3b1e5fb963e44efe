"""The next recording: an input, or a set point, that would tell the leading hypotheses apart or shrink a parameter's deviation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from greybox_torch.api.design_loops import entries_of, loops_for
from greybox_torch.api.design_result import DesignResult
from greybox_torch.api.diagnosis_result import DiagnosisResult
from greybox_torch.api.expected import Expected
from greybox_torch.api.hypotheses import Hypotheses, Kept, hypotheses_of, left_out_told, read_hypotheses, to_tell_apart
from greybox_torch.api.inseparable import same_as_first, told_one_effect
from greybox_torch.api.nothing_open import group_in_question
from greybox_torch.api.plain_arguments import check_seconds, check_seed, check_told
from greybox_torch.errors import ArgumentError, Kind, UserError, did_you_mean
from greybox_torch.estimate.problem import with_card
from greybox_torch.experiment_design.aim import Aim, Trial
from greybox_torch.experiment_design.approach import begun_at, begun_there
from greybox_torch.experiment_design.beginning import Beginning, beginning_of
from greybox_torch.experiment_design.contender import Contender, contender
from greybox_torch.experiment_design.controller import Loop
from greybox_torch.experiment_design.excitation import Excitation
from greybox_torch.experiment_design.imitation import THOROUGH
from greybox_torch.experiment_design.judged import judged_at_estimates
from greybox_torch.experiment_design.limits import Limits, held_as_in, limits_of
from greybox_torch.experiment_design.search import MOST_SAMPLES, frequencies, sampled, search
from greybox_torch.experiment_design.simulated import predictions, within
from greybox_torch.keywords import names_checked
from greybox_torch.linear_algebra import on_one_thread
from greybox_torch.name_lists import listed

RANDOM = 5
"""Random multisines of the same power that the best input (or set point) is compared with."""


@names_checked
@on_one_thread
def design(
    found: DiagnosisResult | str | Path,
    *,
    precision: str | None = None,
    seconds: float | None = None,
    limits: Mapping[str, Any] | None = None,
    controller: Mapping[str, Any] | None = None,
    model: str | None = None,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
) -> DesignResult:
    """Design the input of a next recording, within limits, from what a diagnosis has left open.

    The input is searched among multisines, steps, chirps and slow reversals around operating points, so that the evidence that it is
    expected to give between the leading hypotheses is largest: what a rival cannot imitate with other parameters and start states
    (T-optimality, Atkinson & Fedorov 1975). The experiment begins as the first recording did; where that is in motion, as the first one
    did that is at rest, if any is. Where a controller drives an input, its set
    point is designed, and the machine is simulated under feedback; else the experiment is open loop.

    Args:
        found: the result of ``diagnose``, or the folder that it was saved in.
        precision: a free parameter of the recommended model; its standard deviation is made small instead.
        seconds: how long the recording may be; by default what the limits say, else the longest one that there is.
        limits: as the card's table [limits]; by default that table. What it leaves out is limited to what was recorded; an input that was
            constant in every recording is kept so, and one that is `"recorded"` there is kept as recorded, and so
            is one that has no range there and was never set in steps, where others were, have a range or are driven by a controller.
        controller: as the card's table [controller]; by default that table. An empty one is none.
        model: how to load the plain model, where ``found`` is a folder and the card names none.
        seed: draws inputs, their phases and levels.
        progress: is told what is being done.

    Raises:
        UserError: there are no rivals to tell apart, limits cannot be met, or an argument is at fault.
        NumericalError: a hypothesis cannot be simulated on its own recordings.

    Examples:
        ``design(found, seconds=10, limits={"voltage": {"lower": -6, "upper": 6}}).save("next")``
    """
    check_told("progress", progress)
    held = _hypotheses(found, model)
    given = dict(held.data.limits if limits is None else limits)
    if seconds is not None:
        given["seconds"] = check_seconds("seconds", seconds)
    place = held.data.place("[limits]") if limits is None else "argument limits:"
    plain = held.recommended.model.plain
    entries = entries_of(held.data, controller, plain)
    own = limits_of(held.data, plain, given, place, {name: loop.measured for name, loop in entries.items()})
    progress("reading what the recordings say of each hypothesis")
    step = held.data.recordings[0].sample_time
    aim, begins = _begun(_aim(held, precision, loops_for(entries, plain, own, step)), own)
    like = next(r for r in held.data.recordings if r.name == begins.like)
    own = held_as_in(own, like, step)
    own = replace(own, begin=begun_at(aim.contenders[0], own, step))
    time = step * np.arange(int(np.clip(round(own.seconds / step), 16, MOST_SAMPLES)))
    best = search(aim, own, time, check_seed(seed), progress)
    if not best:
        raise UserError(
            f"{place} no input was found under which every hypothesis keeps outputs and states within their limits, open loop, "
            f"from {_told(begins)}; expected wider limits, fewer seconds or another start"
            if not entries
            else f"{place} no set point of {' and '.join(e.measured for e in entries.values())} was found under which every hypothesis "
            f"keeps inputs, outputs and states within their limits, under feedback, from {_told(begins)}; "
            "expected wider limits, fewer seconds, another start, or a controller that holds the machine"
        )
    progress("judging the best input")
    return _result(held, aim, own, time, best[0], precision, seed, {n: e.measured for n, e in entries.items()}, begins)


def _hypotheses(found: Any, model: str | None) -> Hypotheses:
    if isinstance(found, DiagnosisResult):
        return hypotheses_of(found)
    if isinstance(found, str | Path):
        return read_hypotheses(Path(found), model)
    raise ArgumentError("found", Kind.of(found), "expected the result of diagnose, or the folder that it was saved in")


def _aim(held: Hypotheses, precision: str | None, loops: Sequence[Loop]) -> Aim:
    if precision is not None:
        one = _contender(held.recommended, held, loops)
        free = list(one.problem.free_names)
        if precision not in free:
            hint = _ends_so(precision, free) or did_you_mean(precision, free)
            raise ArgumentError("precision", precision, f"expected a free parameter{hint}: {', '.join(free)}")
        return Aim((one,), free.index(precision))
    return Aim(tuple(_contender(kept, held, loops) for kept in group_in_question(held)))


def _ends_so(name: str, known: Sequence[str]) -> str:
    """The parameters of effects that a bare name may mean, ` (did you mean "actuator.input_lag.T"?)`; "" where none ends so."""
    meant = [f'"{one}"' for one in known if one.rpartition(".")[2] == name]
    return f" (did you mean {listed(meant, 'or')}?)" if meant else ""


def _begun(aim: Aim, limits: Limits) -> tuple[Aim, Beginning]:
    """The aim with all hypotheses begun alike, as suits the likeliest, and how that is."""
    begins = beginning_of(aim.contenders[0], limits.start)
    return replace(aim, contenders=tuple(c.beginning(begins.like, begins.given) for c in aim.contenders)), begins


def _told(begins: Beginning) -> str:
    return f"the start of {begins.like}" + (", but for the states that are asked for" if begins.given else "")


def _contender(kept: Kept, held: Hypotheses, loops: Sequence[Loop] = ()) -> Contender:
    return contender(kept.name, kept.probability, kept.model, held.data, kept.starts, loops)


def _result(
    held: Hypotheses,
    aim: Aim,
    limits: Limits,
    time: np.ndarray,
    best: Trial,
    precision: str | None,
    seed: int,
    follows: Mapping[str, str],
    begins: Beginning,
) -> DesignResult:
    along = predictions(aim.contenders, [best.commands], time)
    names = list(limits.inputs)
    reached = [one.driven([best.commands], float(time[1] - time[0]))[0] for one in aim.contenders]
    shares = tuple(c.probability for c in aim.contenders)
    nats, random, left_out = np.zeros((len(shares),) * 2), None, ()
    before = after = None
    if aim.parameter is None:
        assert best.nats is not None
        nats = best.nats
        random = _by_random_inputs(aim, limits, time, best, seed)
        group, others = to_tell_apart(held)
        same = same_as_first(group)
        left_out = (*([f"{told_one_effect(same)}."] if len(same) > 1 else ()), *left_out_told(others))
    else:
        one = aim.contenders[0]
        after = aim.deviation_after(along[0][0], 0)
        before = one.deviation(aim.parameter)
    return DesignResult(
        data=held.data,
        reference=held.reference,
        limits=limits,
        time=time,
        inputs=dict(zip(names, reached[0], strict=True)),
        excitations=best.candidate,
        names=tuple(c.name for c in aim.contenders),
        hypotheses=tuple(c.problem.model for c in aim.contenders),
        outputs=tuple(own[k].y[0] for k, own in enumerate(along)),
        level=aim.contenders[0].level,
        memory=aim.contenders[0].memory,
        expected=Expected(shares, nats, random),
        begins_like=begins.like,
        start=aim.contenders[0].start,
        parameter=precision,
        unit=next((p.unit for p in with_card(held.data, held.recommended.model) if p.name == precision), ""),
        before=before,
        after=after,
        seed=seed,
        follows=dict(follows),
        set_points={output: best.commands[names.index(name)] for name, output in follows.items()},
        driven=tuple({name: u[names.index(name)] for name in follows} for u in reached),
        on_one_input=tuple(p.y[0] for p in along[0]),
        left_out=left_out,
        moving=begins.moving,
        resting=begins.resting,
    )


def _by_random_inputs(aim: Aim, limits: Limits, time: np.ndarray, best: Trial, seed: int) -> np.ndarray | None:
    """The evidence of a random multisine of the same power, over all frequencies; of several, of the middle one by what it decides."""
    slowest, fastest = frequencies(time)
    tried: list[np.ndarray] = []
    for k in range(RANDOM):
        commands = sampled(
            tuple(Excitation("multisine", slowest, fastest, 0.0, 1.0, seed + 1000 + k) for _ in limits.commanded),
            time,
            limits,
        )
        power, wanted = (np.std(u, axis=1, keepdims=True) for u in (commands, best.commands))
        centre = commands.mean(axis=1, keepdims=True)
        commands = centre + (commands - centre) * wanted / np.maximum(power, 1e-300)
        low, high = (np.array([[getattr(r, end)] for r in limits.commanded.values()]) for end in ("lower", "upper"))
        tried.append(begun_there(np.clip(commands, low, high), time, limits))
    kept = [u for u, fine in zip(tried, within(aim.contenders, limits, tried, time), strict=True) if fine]
    if not kept:
        return None
    found = judged_at_estimates(aim, [Trial(best.candidate, u, 0.0) for u in kept], time)
    middle = sorted(found, key=lambda t: t.score)[len(found) // 2]
    return judged_at_estimates(aim, [middle], time, THOROUGH)[0].nats
