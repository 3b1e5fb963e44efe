"""Recordings of machines, and the card `dataset.toml` that describes them. Needs no torch."""

from greybox_torch.data.card import InitialEntry, ParameterEntry
from greybox_torch.data.dataset import DataSet
from greybox_torch.data.load import load_dataset
from greybox_torch.data.recording import Channel, Recording
from greybox_torch.data.role import Role

__all__ = ["Channel", "DataSet", "InitialEntry", "ParameterEntry", "Recording", "Role", "load_dataset"]
