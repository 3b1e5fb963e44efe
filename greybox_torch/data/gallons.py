"""Gallons, and flows in them, as instruments of either country write them: "gpm", "US gal/min", "imp gal", "gal(UK)/h"."""

from __future__ import annotations

import re

_GALLONS = re.compile(
    r"""(?<![A-Za-z_])(?:(?P<before>US|U\.S\.|UK|imp\.?|imperial)\ ?)? (?:liq(?:uid)?\ )?
        (?P<of>gal(?:lons?)?|gpm|gph)(?![A-Za-z_]) (?:(?P<each>\ ?/\ ?[A-Za-z]+)?\ ?\((?P<behind>US|UK|imp)\))?""",
    re.IGNORECASE | re.VERBOSE,
)
_PER = {"gpm": "_per_minute", "gph": "_per_hour"}
FLOWS = tuple(
    f"{gallon}_per_{time} = {gallon} / {time}"
    for gallon in ("gallon", "imperial_gallon")
    for time in ("minute", "hour")
)
"""Of the registry of units: units of their own, so that a power, or what is divided by one, is that of the whole flow."""


def with_gallons(unit: str) -> str:
    """A unit with its gallons as the registry of units calls them: those of the US, where no country is named."""
    return _GALLONS.sub(_registered, unit)


def _registered(found: re.Match[str]) -> str:
    country, of = (found["before"] or found["behind"] or "").lower(), found["of"]
    if not country and of.startswith("G") and of[1:3].lower() == "al":  # the unit of acceleration
        return found[0]
    gallon = "imperial_gallon" if country.startswith(("uk", "imp")) else "gallon"
    return gallon + _PER.get(of.lower(), "") + (found["each"] or "")
