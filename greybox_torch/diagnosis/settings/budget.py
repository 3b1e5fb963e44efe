"""How much a diagnosis may compute."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.settings.fields import check, count, counts, iteration, number, ratio, share
from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.keywords import fields_checked

TIME = "time and results of the development cases"


@fields_checked
@dataclass(frozen=True, kw_only=True)
class SearchBudget:
    """Limits of the search: how many hypotheses go on at every stage, how far each is refitted, how finely curves are drawn.

    Example: ``SearchBudget(most_effects=2, finalists=2)`` finds two effects at most, with fewer full refits.

    Raises:
        UserError: a value is out of its bounds.
    """

    most_effects: int = count(4, "Effects that a hypothesis may have.", chosen_by=TIME)
    most_revisions: int = count(
        2, "How often the choice of earlier effects is taken up again.", chosen_by=TIME, least=0
    )
    names_before_memory: int = count(
        2,
        "Effects found that leave more than noise, before a residual with memory is tried in their place.",
        chosen_by=TIME,
    )
    most_samples: int = count(
        100_000,
        "Samples of all recordings of one role that are searched; of longer ones the stretch that moves most is.",
        unit="samples",
        chosen_by=TIME,
        least=1000,
    )
    least_samples: int = count(
        5_000,
        "Samples that the recordings of a role keep at least where one of several is searched.",
        unit="samples",
        chosen_by=TIME,
        least=1000,
    )
    most_passed_over: int = count(
        9, "Samples between two of those that are searched, at most; 0 searches all.", chosen_by=TIME, least=0
    )
    window_factors: tuple[int, ...] = counts(
        (1, 4, 16),
        "Window lengths as multiples of the shortest: short windows forgive a wrong trajectory, long ones show slow effects.",
        unit="shortest windows",
        chosen_by=TIME,
    )
    windows_of_longest: int = count(
        64, "How many of the shortest windows the longest record has.", unit="windows", chosen_by=TIME
    )
    shortest_window: int = count(20, "Samples that a window has at least.", unit="samples", chosen_by=TIME, least=2)

    first_iterations: Settings = iteration(
        Settings(iterations=10, tolerance=3e-3, trials=5),
        "How far every start of a fit over windows is followed.",
        chosen_by=TIME,
    )
    trial_iterations: Settings = iteration(
        Settings(iterations=14, tolerance=1e-3, trials=5),
        "How far a candidate is refitted in its trial.",
        chosen_by=TIME,
    )
    window_iterations: Settings = iteration(
        Settings(iterations=30, tolerance=3e-4, trials=6), "How far a finalist is refitted.", chosen_by=TIME
    )
    polish_iterations: Settings = iteration(
        Settings(iterations=60, tolerance=1e-5, trials=6),
        "How far what is compared in the end is refitted.",
        chosen_by=TIME,
    )
    mismatch_tolerance: float = share(
        3e-4,
        "Tolerance of a fit that leaves more than noise, if not larger: decisions are then by differences of some "
        "thousandths in the logarithm of the error, not by the likelihood of every sample.",
        unit="share of the cost",
        chosen_by="a tenth of the price of a parameter",
    )
    rough_mismatch_tolerance: float = share(
        3e-3,
        "The same for fits that only choose what is fitted further.",
        unit="share of the cost",
        chosen_by="a tenth of the difference up to which hypotheses tie",
    )
    record_first_iterations: Settings = iteration(
        Settings(iterations=12, tolerance=1e-3),
        "How far every start of the final fit on whole records is followed.",
        chosen_by=TIME,
    )
    record_iterations: Settings = iteration(
        Settings(iterations=60, tolerance=1e-6), "How far the final fit on whole records is followed.", chosen_by=TIME
    )
    position_trial_iterations: Settings = iteration(
        Settings(iterations=5, tolerance=1e-2, trials=3),
        "How far a trial of a start position is followed.",
        chosen_by=TIME,
    )
    position_iterations: Settings = iteration(
        Settings(iterations=20, tolerance=1e-4, trials=5),
        "How far the start states of held-out windows are fitted.",
        chosen_by=TIME,
    )

    rival_start: float = ratio(
        4.0,
        "How many times the best mean squared error a start may be at, after its first iterations, and still be followed.",
        unit="times the best mean squared error",
        chosen_by=TIME,
    )
    rival_pace: float = ratio(
        2.0,
        "How many times as fast as in its last iteration a start is expected to gain in those still to come; "
        "where that would not bring it level with the best, it is given up.",
        unit="times its last gain",
        chosen_by=TIME,
    )
    most_turns: int = count(
        3, "How often a fit is taken up again after carried states were brought along.", chosen_by=TIME
    )
    least_turn_gain: float = share(
        0.03,
        "Gain from which another such turn is worth while.",
        unit="share of the mean squared error",
        chosen_by=TIME,
    )

    other_values: int = count(
        64,
        "Start values of the model as it stands that are followed where what was found leaves more than noise.",
        chosen_by="a wrist that lacks nothing: with 32 it is left at four times the noise, with 64 at noise alone",
    )

    named_per_length: int = count(4, "Named candidates that the screen passes on, by window length.", chosen_by=TIME)
    curves_per_length: int = count(
        1, "Free curves that the screen passes on, by window length.", chosen_by=TIME, least=0
    )
    curves_with_memory: int = count(
        2,
        "Residuals with memory that are screened with a curve in front, by window length: those that explain most without.",
        chosen_by=TIME,
    )
    part_elsewhere: float = share(
        0.8,
        "Share of what the best named candidate explains from which the first at another kind of place is passed on beside those.",
        unit="share of what the best explains",
        chosen_by="a speed sensor's offset explained 0.91 of it; a lag of one second of a torque sensor, which nobody knows of, 0.76",
    )
    most_screen_ties: int = count(8, "Named candidates that it passes on where they tie.", chosen_by=TIME)
    order_peaks: int = count(
        2, "Orders of a periodic effect that the scan follows, by window length and family.", chosen_by=TIME
    )
    order_steps: int = count(400, "Steps of the grid of orders.", chosen_by=TIME, least=4)

    from_motion: int = count(
        2,
        "Candidates that the measured motion adds to the screen's, by form of the equations.",
        chosen_by=TIME,
        least=0,
    )

    trial_starts: int = count(2, "Start values of a candidate that are tried.", chosen_by=TIME)
    substeps_of_dry_friction: int = count(
        8,
        "Runge-Kutta steps per sample with which dry friction is tried again that comes to less than the screen promises: where it holds a "
        "light body it is stiff.",
        unit="times those of the model",
        chosen_by="a valve's packing at 500 Hz: with 4 its trial fails, with 8 it leads, with 16 it takes twice as long",
    )
    promise_of_dry_friction: float = share(
        0.3,
        "Share of the residual that the screen has to promise of dry friction for it to be tried in finer steps where it lacks much of "
        "that.",
        unit="share of the residual's energy",
        chosen_by=TIME,
    )
    most_of_promise_missing: float = share(
        0.5, "Part of the promise that it then has to lack.", unit="share, as logarithms of the error", chosen_by=TIME
    )
    part_of_missing_promise: float = share(
        0.25,
        "Part of what it lacks of the promise that finer steps have to bring for its model to keep them: they cost as many times more.",
        unit="share, as logarithms of the error",
        chosen_by=TIME,
    )
    left_in_finer_steps: float = share(
        0.6,
        "Part of the error that finer steps may leave for what was found to keep them: every later pass takes as many times as long.",
        unit="share of the mean squared error",
        chosen_by="a slide whose friction was right in them: 0.46; a cylinder of which no more was found, thrice as slowly: 0.84",
    )
    finalists: int = count(3, "Hypotheses that are refitted at every window length after their trial.", chosen_by=TIME)
    most_tied: int = count(6, "Named hypotheses that go on where they tie.", chosen_by=TIME)
    front_runners: int = count(3, "Hypotheses that are polished before they are compared.", chosen_by=TIME)
    most_polishes: int = count(4, "Further refits of a law that may act at either end of a spring.", chosen_by=TIME)
    most_shapes: int = count(3, "Shapes of a law that it is refitted from against local minima.", chosen_by=TIME)
    order_shifts: tuple[int, ...] = counts(
        (-2, -1, 1, 2),
        "Shifts by which the order of a periodic effect is tried anew.",
        unit="quarter periods over the travel",
        chosen_by=TIME,
        least=-float("inf"),
    )
    part_of_curve: float = share(
        0.1,
        "Part of a suggested curve that its refit also begins with: the whole at once can lead out of the valley.",
        unit="share of the suggested heights",
    )

    knots: int = count(14, "Knots of a free curve to begin with.", chosen_by=TIME, least=4)
    fine_knots: int = count(40, "Knots of the curves that are tried when nothing else pays.", chosen_by=TIME, least=4)
    knots_along_parts: int = count(
        120, "Knots along the whole way of those curves that are drawn over a part of it.", chosen_by=TIME, least=14
    )
    knots_of_part: int = count(10, "Knots that such a curve has.", chosen_by=TIME, least=4)
    part_at_other_bodies: float = share(
        0.8,
        "Share of what the best of these explains from which one at another body is passed on: all bodies pass the place at once.",
        unit="share of what the best explains",
        chosen_by="a notch of a motor, whose curve explained 0.98 of what one at the gearbox did, and came to the noise alone",
    )
    most_parameters: int = count(70, "Free parameters beyond which a curve is not drawn any finer.", chosen_by=TIME)

    share_for_confirming: float = share(
        0.15,
        "Under a time limit, what is kept of it for confirming on held-out experiments.",
        unit="share of the time",
        chosen_by=TIME,
    )
    share_for_final_fits: float = share(
        0.1, "The same for the final fits on whole records.", unit="share of the time", chosen_by=TIME
    )
    comparisons_to_come: float = number(
        5.0,
        "Time kept for free runs and for describing what was found, in comparisons of one model with all experiments.",
        unit="comparisons",
        chosen_by=TIME,
    )
    seconds_for_writing: float = number(0.5, "Time kept for writing results.", unit="s", chosen_by=TIME)

    def __post_init__(self) -> None:
        check(self)
