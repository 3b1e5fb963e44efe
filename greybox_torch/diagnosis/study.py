"""What a search is about: the data, the model, and by what it is decided. None of it changes while effects are chosen."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from greybox_torch.deadline import check_time
from greybox_torch.diagnosis.beliefs import Beliefs
from greybox_torch.diagnosis.places import Places
from greybox_torch.diagnosis.progress import Journal
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.reconstruction import Motion
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import DEFAULT, SimulationOptions


def silent(text: str) -> None:
    """Reports nothing."""


@dataclass(frozen=True)
class Study:
    """The estimation experiments with the model as it stands, and how it is looked for what they lack.

    ``options`` are those of every simulation. ``surroundings`` and ``shifts`` are what mechanisms need to know of the ports: where signals
    moved, and which state carries the deflection of a coupling; both are known once the model as it stands is fitted. ``at_card``: windows
    with the card's parameter values, where that fit is bent (``bent``: by a parameter far from the card's). ``motion``: what the outputs
    show of the states, or why they do not. ``recorded``: all samples of the estimation experiments, where ``problem`` has some of them.
    ``places``: where positions begin that no sensor shows, as a search with fewer experiments left them. ``beliefs``: what is known
    beforehand. ``more_is_missing``: whether free runs show that what is left matters, however little of the mismatch it is over windows.
    ``report`` is told what is being done, ``journal`` which candidates are tried.
    """

    problem: Problem
    options: SimulationOptions = DEFAULT
    surroundings: Mapping[str, Surroundings] = field(default_factory=dict)
    shifts: Mapping[str, str] = field(default_factory=dict)
    motion: Motion | str | None = None
    at_card: tuple[WindowFit, ...] = ()
    bent: bool = False
    recorded: Records | None = None
    places: Places = field(default_factory=dict)
    settings: DiagnosisSettings = field(default_factory=DiagnosisSettings)
    budget: SearchBudget = field(default_factory=SearchBudget)
    beliefs: Beliefs = field(default_factory=Beliefs)
    more_is_missing: bool = False
    report: Callable[[str], None] = silent
    journal: Journal = field(default_factory=Journal)

    def working_on(self, text: str) -> None:
        """Report what is begun now, if there is time left for it.

        Raises:
            TimeIsUp: there is not.
        """
        self.report(text)
        check_time()

    @property
    def card(self) -> dict[str, float]:
        """The parameter values that the problem began with, by name."""
        return self.problem.values_by_name
