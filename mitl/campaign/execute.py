"""Runs the trials of a campaign on Dask: here by default, or on any scheduler.

Invariant: what is finished is kept at once; a worker that dies costs nothing but the trial it was at, which is run again.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from pathlib import Path

from mitl.campaign.plan import Trial
from mitl.campaign.store import ResultFile, read_results
from mitl.campaign.trial import TrialResult, run_trial
from mitl.errors import RigError

_RETRIES = 3
_ANY_PORT = "127.0.0.1:0"
"""Where Dask's web page is served: a port of its own, so that several campaigns may run on one computer, and for nobody else."""


def execute(
    trials: Sequence[Trial],
    folder: Path,
    *,
    workers: int = 2,
    scheduler: str | None = None,
    progress: Callable[[int, int], None] = lambda _done, _all: None,
    run: Callable[[Trial], TrialResult] = run_trial,
) -> dict[str, TrialResult]:
    """Gives the results of all trials by key, those of an interrupted campaign in the folder included.

    workers: processes on this computer, where no scheduler's address is given. progress: told how many of how many are done. run: what does
    a trial; it is pickled. Raises RigError where the scheduler does not answer, and what a trial raises.
    """
    from dask.distributed import Client, LocalCluster, as_completed  # noqa: PLC0415 - heavy, and only where trials are left to run

    done = read_results(folder)
    wanted = {trial.key: trial for trial in trials}
    left = [trial for key, trial in wanted.items() if key not in done]
    progress(len(wanted) - len(left), len(wanted))
    if left:
        cluster = None
        try:
            if scheduler is None:
                cluster = LocalCluster(
                    n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=_ANY_PORT, silence_logs=logging.ERROR
                )
            client = Client(cluster if cluster is not None else scheduler, timeout="10s")
        except (OSError, TimeoutError) as error:
            raise RigError(f"no Dask scheduler answers at {scheduler}: {error}") from error
        file = ResultFile(folder)
        try:
            futures = client.map(run, left, key=[f"trial {trial.key}" for trial in left], retries=_RETRIES, pure=True)
            for future in as_completed(futures):
                result = future.result()
                file.add(result)
                done[result.key] = result
                progress(len(wanted) - len(left) + sum(trial.key in done for trial in left), len(wanted))
        finally:
            file.close()
            client.close()
            if cluster is not None:
                cluster.close()
    return {key: done[key] for key in wanted}
