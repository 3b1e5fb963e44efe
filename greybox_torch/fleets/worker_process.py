"""What a worker process of the cluster on this machine does before its first data set. Needs the extra `fleet`."""

from __future__ import annotations

import os
import signal
from typing import Any

from distributed import WorkerPlugin


class ProcessOfOurs(WorkerPlugin):
    """Ctrl-C is for the process that shares out the work, which then ends the workers; what a model prints goes to standard error."""

    name = "greybox-fleet"

    def setup(self, worker: Any) -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        os.dup2(2, 1)
