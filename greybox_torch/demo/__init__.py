"""The data set of `greybox demo`: a simulated arm with one concealed effect, made by experiments/concealed/make_demo.py.

The code that made it shares nothing with this package. The answer is in key.json, which nothing here reads.
"""

from __future__ import annotations

from pathlib import Path

DATASET = Path(__file__).with_name("dataset.toml")

__all__ = ["DATASET"]
