"""The sentence of a verdict without effects: nothing is missing, or what is could not be named, and why."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.digits import digits

NOISE_SHOWN = "(read from the recordings' highest frequencies)"
"""What is meant by the noise: not all that disturbs, but the sensors' own, which is little where an encoder has fine steps."""


@dataclass(frozen=True)
class WithoutEffects:
    """What is known where nothing was found.

    ``unexplained``: how many times the noise the error is, None where that is not clearly more; ``output`` in which it is, where in one;
    ``looked`` and ``complete``: whether anything was looked for, and to the end; ``too_short``: a clause where the recordings to
    choose with are too short to tell anything from chance, else "". ``excluded``: whether beliefs kept some laws from being tried.
    ``unsure``: a clause on a candidate that would explain much of it and is not sure, or that the screen alone points to, else "".
    ``disturbed``: how many times the noise the error is where nothing says that more is missing than knowledge of a disturbance, else None.
    """

    model: str
    confidence: float
    unexplained: float | None
    output: str
    looked: bool
    complete: bool
    too_short: str = ""
    excluded: bool = False
    unsure: str = ""
    disturbed: float | None = None

    @property
    def sentence(self) -> str:
        """For a reader."""
        if self.unexplained is not None:
            its = f"its error, mostly in {self.output}," if self.output else "its error"
            times = f"at least {digits(self.unexplained, 3)} times the noise {NOISE_SHOWN}, over short windows and in free runs alike"
            return f"Something is missing from {self.model}: {its} is {times}. {self._why}"
        if not self.looked:
            return f"Nothing was looked for in {self.model}: the beliefs exclude every hypothesis."
        if not self.complete:
            return f"Nothing was found to be missing from {self.model} before the search was stopped: no answer yet{self._so_far}."
        but = ""
        if self.disturbed is not None:
            but = (
                f", but on the worst experiment its error is {digits(self.disturbed, 3)} times the noise {NOISE_SHOWN}: it follows neither "
                "the inputs nor any law that was tried, and whether a disturbance leaves it or something that the model lacks is not known"
            )
        return f"Nothing is missing from {self.model} that these recordings can show (confidence {self.confidence:.2f}){but}."

    @property
    def _so_far(self) -> str:
        """What a search that was stopped has of a candidate."""
        return f": so far, {self.unsure}" if self.unsure else ""

    @property
    def _why(self) -> str:
        """Why what is missing has no name."""
        if not self.looked:
            return "What it is was not looked for, as the beliefs exclude every hypothesis."
        if self.too_short:
            return f"What it is cannot be told: {self.too_short}."
        if not self.complete:
            return f"The search was stopped before it could say what{self._so_far}."
        surely = "surely explains" if self.unsure else "explains"
        said = f"No law of the library and no curve of one signal {surely} it, with or without memory"
        if self.excluded:
            said = f"None of the laws and curves that were tried {surely} it (the beliefs exclude others)"
        return f"{said}: {self.unsure}." if self.unsure else f"{said}."
