"""What may be wrong with a data set although it can be read: the warnings of all commands, from one place."""

from __future__ import annotations

from typing import TYPE_CHECKING

from greybox_torch.api.refused_tables import refused_tables
from greybox_torch.checking.clipped_outputs import clipped_outputs
from greybox_torch.checking.constant_channels import constant_channels
from greybox_torch.checking.joined_files import joined_files
from greybox_torch.checking.late_sensors import late_sensors
from greybox_torch.checking.little_in_common import counters_as_time, little_in_common
from greybox_torch.checking.lone_samples import lone_samples
from greybox_torch.checking.missing_inputs import missing_inputs
from greybox_torch.checking.other_units import other_units
from greybox_torch.checking.percentages import percentages
from greybox_torch.checking.scale_of_time import decades
from greybox_torch.checking.shared_columns import shared_columns
from greybox_torch.checking.shared_rows import shared_rows
from greybox_torch.checking.short_records import short_records
from greybox_torch.checking.stuck_sensors import stuck_sensors
from greybox_torch.checking.time_stamps import odd_time_stamps
from greybox_torch.checking.wrapped_channels import wrapped_channels
from greybox_torch.data import DataSet
from greybox_torch.data.data_warning import DataWarning, InASentence
from greybox_torch.drafting.contradicted import contradictions
from greybox_torch.drafting.contradicted_steps import contradicted_steps

if TYPE_CHECKING:
    from greybox_torch.model import GreyBoxModel


class NothingToEstimateFrom(InASentence):
    """No experiment has the role "estimation"."""

    found = (
        '[[experiment]] role: no experiment has the role "estimation", which `greybox fit`, `diagnose` and `train` need'
    )
    write = 'role = "estimation" for at least one'


def all_warnings(data: DataSet, model: GreyBoxModel | None) -> list[DataWarning]:
    """Those of :func:`data_warnings`, and before them what other commands refuse: for those that look at data before anything is done."""
    refused = () if data.estimation() else (NothingToEstimateFrom(),)
    tables = () if model is None else refused_tables(data, model)
    return [*refused, *tables, *data_warnings(data, model)]


def data_warnings(data: DataSet, model: GreyBoxModel | None) -> list[DataWarning]:
    """Those of a data set; without a model, as far as they need none."""
    joined = joined_files(data)  # reads the files again, therefore once
    return [
        *contradictions(data.path),
        *contradicted_steps(data),
        *odd_time_stamps(data, joined),
        *decades(data),
        *little_in_common(joined),
        *counters_as_time(data),
        *shared_columns(data),
        *shared_rows(data),
        *constant_channels(data, model),
        *lone_samples(data, joined),
        *stuck_sensors(data, model),
        *(clipped_outputs(data, model) if model is not None else ()),
        *wrapped_channels(data),
        *percentages(data),
        *other_units(data),
        *(missing_inputs(data, model) if model is not None else ()),
        *(late_sensors(data, model) if model is not None else ()),
        *(short_records(data, model) if model is not None else ()),
    ]
