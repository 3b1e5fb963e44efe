"""What is known of a machine before any recording: how likely a hypothesis is, by port and mechanism.

A belief is a probability that a hypothesis is the right one where the recordings leave that open; one half says nothing. Its odds
p / (1 − p) weigh the hypothesis among its rivals; zero takes it out of the search. Beliefs decide between names, never whether anything
is missing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from greybox_torch.errors import UserError, check_none, did_you_mean
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import GreyBoxModel

ANY = "*"
WORDS = {"unlikely": 0.1, "likely": 0.9}
"""The probabilities that words stand for."""

_EXPECTED = 'expected "PORT/MECHANISM", with * in the place of either for any'


@dataclass(frozen=True)
class Beliefs:
    """``given``: probabilities by "port/mechanism", where either may be ``*``. Without any, all hypotheses are alike."""

    given: Mapping[str, float] = field(default_factory=dict)

    def log_odds(self, port: str, mechanism: str) -> float:
        """Logarithm of the odds of a hypothesis, minus infinity where it is excluded, zero where nothing is said of it.

        An entry of both names stands alone; those of the port and of the mechanism are taken as independent, and add.
        """
        exact = self.given.get(f"{port}/{mechanism}")
        if exact is not None:
            return _log_odds(exact)
        said = (self.given.get(f"{port}/{ANY}"), self.given.get(f"{ANY}/{mechanism}"))
        return sum((_log_odds(p) for p in said if p is not None), 0.0)

    def weight(self, attachment: Attachment) -> float:
        """The odds of an effect; one where nothing is said of it."""
        mechanism = Unknown.name if attachment.mechanism.free else attachment.mechanism.name
        return math.exp(self.log_odds(attachment.port, mechanism))

    def exclude(self, attachment: Attachment) -> bool:
        """Whether an effect is not to be considered."""
        return self.weight(attachment) == 0.0

    @property
    def exclude_some(self) -> bool:
        """Whether any hypothesis is excluded."""
        return 0.0 in self.given.values()

    def exclude_all(self, model: GreyBoxModel) -> bool:
        """Whether no mechanism of the library, and no curve, is left at any port of a model."""
        laws = {**LIBRARY, Unknown.name: Unknown}
        places = ((p.name, name) for p in model.all_ports for name, law in laws.items() if p.kind in law.kinds)
        return bool(self.given) and all(self.log_odds(*place) == -math.inf for place in places)


NO_BELIEFS = Beliefs()
"""All hypotheses are alike."""


def beliefs_from_mapping(mapping: Mapping[str, Any], model: GreyBoxModel, where: str) -> Beliefs:
    """Beliefs as a card's table ``[beliefs]`` has them, checked against the ports of ``model`` and the library.

    Args:
        where: what a message begins with, such as ``dataset.toml: [beliefs]``.

    Raises:
        UserError: a key that is none, a port or mechanism that there is not, a mechanism that its port cannot have, or a value that is
            neither a probability below one nor a word.
    """
    if not isinstance(mapping, Mapping):
        raise UserError(f"{where}: found {mapping!r}, expected a table of beliefs by port and mechanism")
    given: dict[str, float] = {}
    problems: list[str] = []
    for key, value in mapping.items():
        try:
            given[_key(key, model)] = _probability(value, key)
        except UserError as error:
            problems.append(str(error))
    check_none(problems, where)
    return Beliefs(given)


def _key(key: Any, model: GreyBoxModel) -> str:
    port, slash, mechanism = key.partition("/") if isinstance(key, str) else ("", "", "")
    if not (port and slash and mechanism) or "/" in mechanism or port == mechanism == ANY:
        raise UserError(f'"{key}" is no hypothesis; {_EXPECTED}')
    kinds = {p.name: p.kind for p in model.all_ports}
    known = {**{name: law.kinds for name, law in LIBRARY.items()}, Unknown.name: Unknown.kinds}
    if port != ANY and port not in kinds:
        raise UserError(
            f'"{key}": model {model.title} has no port "{port}"{did_you_mean(port, kinds)}; expected one of '
            f"{', '.join(kinds)}, or * for any"
        )
    if mechanism != ANY and mechanism not in known:
        raise UserError(
            f'"{key}": there is no mechanism "{mechanism}"{did_you_mean(mechanism, known)}; expected one of the library, '
            f"{Unknown.name}, or * for any"
        )
    if ANY not in (port, mechanism) and kinds[port] not in known[mechanism]:
        raise UserError(
            f'"{key}": {port} is a port of the kind "{kinds[port]}"; {mechanism} attaches to {", ".join(known[mechanism])}'
        )
    return key


def _probability(value: Any, key: str) -> float:
    if isinstance(value, str) and value in WORDS:
        return WORDS[value]
    if isinstance(value, int | float) and not isinstance(value, bool) and 0.0 <= value < 1.0:
        return float(value)
    raise UserError(
        f'"{key}": found {value!r}; expected {", ".join(map(repr, WORDS))}, or a probability from 0 (excluded) to below 1'
    )


def _log_odds(probability: float) -> float:
    return -math.inf if probability == 0.0 else math.log(probability / (1.0 - probability))
