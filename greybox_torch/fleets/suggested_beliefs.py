"""What the verdicts of a fleet say beforehand of a further machine of the same model, as a card's table `[beliefs]`.

With a Dirichlet prior of one machine for each hypothesis (the rule of succession, Laplace 1774), a hypothesis that k machines were found
with is k + 1 times as likely as one that none was: a belief of (k + 1) / (k + 2), whose odds these are.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from greybox_torch.diagnosis.one_of import spoken
from greybox_torch.files import toml_text
from greybox_torch.fleets.in_common import latest
from greybox_torch.fleets.row import Row

FEWEST = 5
"""Machines with a name below which nothing is suggested."""
TWICE = 2
"""Machines that a name has to be found at: one verdict alone may be wrong."""
HIGHEST = 0.95
"""The strongest belief: a machine of another kind is still to be heard."""


@dataclass(frozen=True)
class SuggestedBeliefs:
    """Of machines of ``model``: ``found``, how many have which effect by "port/mechanism", of ``of`` machines that were diagnosed."""

    model: str
    found: Mapping[str, int]
    of: int

    @property
    def beliefs(self) -> dict[str, float]:
        """Probabilities as :func:`greybox_torch.diagnose` takes them, the strongest first."""
        return {key: round(min(HIGHEST, (k + 1) / (k + 2)), 3) for key, k in self.found.items()}

    @property
    def file(self) -> str:
        """The name of its file."""
        return f"beliefs_{re.sub(r'[^A-Za-z0-9]+', '_', self.model).strip('_') or 'model'}.toml"

    def toml(self) -> str:
        """A table to go into the cards of further machines."""
        lines = [f"{toml_text(key)} = {value}  # {self.found[key]} machines" for key, value in self.beliefs.items()]
        head = (
            f"# What {self.of} machines of {self.model} were found with, each by its latest recording.\n"
            "# For the cards of further machines of this model: for one that is counted here it would count twice.\n[beliefs]\n"
        )
        return head + "".join(f"{line}\n" for line in lines)

    def as_json(self) -> dict[str, Any]:
        return {"model": self.model, "beliefs": self.beliefs, "found": dict(self.found), "of": self.of}


def suggested_beliefs(rows: Iterable[Row]) -> tuple[SuggestedBeliefs, ...]:
    """Of every model for which enough machines were found with one effect by name.

    What recordings leave open between several names does not count.
    """
    machines = [row for row in latest(rows) if row.answer not in ("failed", "unfinished")]
    result = []
    for model in sorted({row.model for row in machines}):
        own = [row for row in machines if row.model == model]
        counts = Counter(f"{row.port}/{row.mechanism}" for row in own if _one_name(row))
        found = {key: k for key, k in counts.most_common() if k >= TWICE}
        if found and counts.total() >= FEWEST:
            result.append(SuggestedBeliefs(model, found, len(own)))
    return tuple(result)


def _one_name(row: Row) -> bool:
    return row.answer == "named" and row.effect == f"{spoken(row.mechanism)} at {row.port}"
