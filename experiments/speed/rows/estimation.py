"""Row 3: the published estimation, warm."""

from __future__ import annotations

from collections.abc import Callable

from experiments.speed.adam import Descent, descend, our_gradient
from experiments.speed.records import Published, load_problem, published
from experiments.speed.row import Entry, Row, Target
from experiments.speed.rows import Needs, Progress
from experiments.speed.settings import PUBLISHED_CARD, Settings
from experiments.speed.timing import interleaved, once
from greybox_torch.estimate import Problem, fit_records

TITLE = "Published estimation: 7 parameters, 3 start speeds, 19 838 samples"
NEEDS = Needs(peers=("jax", "optimistix", "numba"), recordings=True)
PUBLISHED_MSE = 9.46671
"""(rad/s)², of an independent implementation."""
TOLERANCE = 1e-4
"""Relative difference of the mean squared error up to which two optima are the same."""

GRADIENT_SAMPLES = 2000
"""Samples of the record that a gradient of torchdiffeq is timed on."""

OURS = "ours, fit"
DOCUMENTED, TUNED = "optimistix LM, as documented", "optimistix LM, loose tolerance, Cholesky"
BY_HAND = "SciPy least_squares + Numba, derivatives by hand"
ADAM = "torchdiffeq odeint rk4 + Adam"

Estimate = Callable[[], float]


def measure(settings: Settings, progress: Progress) -> Row:
    problem = load_problem(PUBLISHED_CARD)
    task = published(problem)
    rivals = _rivals(problem, task)
    if settings.quick:
        rivals = {name: call for name, call in rivals.items() if name not in (DOCUMENTED, BY_HAND)}
    compiling, errors = {}, {}
    for name, call in rivals.items():
        progress(f"first run of {name}")
        first, _ = once(call)
        again, errors[name] = once(call)
        compiling[name] = None if name == OURS else max(first - again, 0.0)
    progress("timing")
    times = {name: t.median for name, t in interleaved(rivals, repeats=settings.repeats(5)).items()}
    optimum = errors[OURS]
    same = {name: abs(mse / optimum - 1) <= TOLERANCE for name, mse in errors.items()}
    adam_seconds, gradient_seconds, descent = _adam(problem, task, optimum, settings, progress)
    optimistix = min((times[n] for n in (DOCUMENTED, TUNED) if same.get(n)), default=None)
    entries = [
        Entry(n, times[n], compiling[n], n == OURS, f"MSE {errors[n]:.6g}{'' if same[n] else ', NOT the same optimum'}")
        for n in rivals
    ]
    return Row(
        "estimation",
        TITLE,
        entries=(*entries, Entry(ADAM, adam_seconds, note=_adam_note(gradient_seconds, descent, settings))),
        targets=(
            Target("faster than optimistix", "at least", 2.0, optimistix and optimistix / times[OURS]),
            Target("faster than torchdiffeq + Adam", "at least", 50.0, adam_seconds / times[OURS]),
        ),
        agreement=f"our MSE {optimum:.6g}, independent reference {PUBLISHED_MSE}; others must come within {TOLERANCE:.0e} of ours",
        notes=("ours without standard deviations, machine code in the cache and the stepper made anew",),
    )


def _rivals(problem: Problem, task: Published) -> dict[str, Estimate]:
    """Estimations by name; each returns its mean squared error."""
    from experiments.speed.peers import jax_fit, scipy_fit

    data = (task.start, task.p, task.x0, task.u, task.y, task.free, task.free_states)
    documented = jax_fit.with_optimistix(task.scale, documented=True)
    tuned, written = jax_fit.with_optimistix(task.scale), jax_fit.written_out(task.scale)
    return {
        OURS: lambda: fit_records(problem, with_uncertainty=False).mse,
        DOCUMENTED: lambda: float(documented(*data)[1]),
        TUNED: lambda: float(tuned(*data)[1]),
        "JAX, LM written out": lambda: float(written(*data)[1]),
        "SciPy least_squares + Numba, differences": lambda: scipy_fit.estimate(task, "differences")[1],
        BY_HAND: lambda: scipy_fit.estimate(task, "sensitivities")[1],
    }


def _adam(
    problem: Problem, task: Published, optimum: float, settings: Settings, progress: Progress
) -> tuple[float, float, Descent]:
    """Seconds that torchdiffeq and Adam would take (a lower bound where Adam did not arrive), seconds of a gradient, Adam's path."""
    from experiments.speed.peers import torchdiffeq_arm

    samples = 200 if settings.quick else GRADIENT_SAMPLES
    progress(f"torchdiffeq: gradients on {samples} samples")
    short = task.shortened(samples)
    timing = interleaved({ADAM: lambda: torchdiffeq_arm.gradient(short, task.start)})[ADAM]
    seconds = timing.median * len(task.y) / samples
    progress("counting Adam's steps with gradients of our engine")
    descent = descend(
        our_gradient(problem, task), task, optimum, most=50 if settings.quick else 3000, tolerance=TOLERANCE
    )
    return seconds * descent.steps, seconds, descent


def _adam_note(seconds: float, descent: Descent, settings: Settings) -> str:
    samples = 200 if settings.quick else GRADIENT_SAMPLES
    bound = "reaching" if descent.arrived else "a lower bound: the best learning rate has then only reached"
    return (
        f"extrapolated: {descent.steps} steps of {seconds:.3g} s, {bound} MSE {descent.mse:.6g}; a gradient was timed on {samples} samples "
        f"and scaled to the record, the steps counted with gradients of our engine (learning rate {descent.learning_rate})"
    )
