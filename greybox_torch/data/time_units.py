"""Units of time stamps, as data loggers write them."""

from __future__ import annotations

_SPELT = {
    "s": "s sec secs second seconds sek sekunde sekunden seconde secondes",
    "ms": "ms msec msecs millis millisec millisecs millisecond milliseconds millisekunden millisecondes",
    "us": "us µs usec usecs µsec micros microsec microsecs microsecond microseconds mikrosekunden",
    "ns": "ns nsec nsecs nanos nanosec nanosecs nanosecond nanoseconds nanosekunden",
    "min": "min mins minute minutes minuten",
    "h": "h hr hrs hour hours stunde stunden heure heures",
}
SPELLINGS = {spelling: unit for unit, spelt in _SPELT.items() for spelling in spelt.split()}
"""The unit that a card has, by how it may be written, in small letters."""


def unit_of_time(said: str) -> str:
    """The unit of the card ("s", "ms", "us", "ns", "min", "h") that a file means by what it says; "" where that is no unit of time."""
    return SPELLINGS.get(said.strip("[](). ").lower().replace("μ", "µ"), "")
