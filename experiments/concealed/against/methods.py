"""The other ways by name, and what each makes of a case."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from experiments.concealed.against.judge import SCHEMA, Answer, result
from experiments.concealed.against.plain import Plain
from greybox_torch import NumericalError


def _retuned(plain: Plain) -> tuple[Answer, ...]:
    values = plain.problem.values_by_name
    return (Answer(plain.problem.model, values, None),)


def _sindy(plain: Plain) -> tuple[Answer, ...]:
    from experiments.concealed.against.sparse_regression import sparse_regression

    return sparse_regression(plain)


def _network(plain: Plain) -> tuple[Answer, ...]:
    from experiments.concealed.against.neural_residual import neural_residual

    return (neural_residual(plain),)


METHODS: dict[str, tuple[tuple[str, ...], Callable[[Plain], tuple[Answer, ...]]]] = {
    "retuned": (("retuned",), _retuned),
    "sindy": (("sindy", "sindy_refitted"), _sindy),
    "network": (("network",), _network),
}
"""By name: the baselines that a method answers for, and the method."""

BASELINES = tuple(baseline for baselines, _ in METHODS.values() for baseline in baselines)


def results(plain: Plain, method: str) -> dict[str, dict[str, Any]]:
    """What a method makes of a case, by baseline; where its numbers fail, that is the result, with what failed under ``failed``."""
    baselines, answer = METHODS[method]
    began = time.perf_counter()
    try:
        answers = answer(plain)
        seconds = plain.seconds + time.perf_counter() - began
        return {b: result(plain, b, a, seconds) for b, a in zip(baselines, answers, strict=True)}
    except (NumericalError, np.linalg.LinAlgError) as error:
        seconds = plain.seconds + time.perf_counter() - began
        return {b: {"schema": SCHEMA, "baseline": b, "seconds": seconds, "failed": str(error)} for b in baselines}
