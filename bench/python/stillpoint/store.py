# SPDX-License-Identifier: BSD-3-Clause
"""Stores of results: runs, metrics, trajectories and series as arrays, and the statistics of `stillpoint stats` and `compare`.

    store = Store("runs.sqlite")
    table = store.frame()                       # pandas: one row per run
    groups, left_out = select_runs(store, store.runs())
    for spread in run_spreads(groups[0].runs, "ate_rmse_m"): ...
"""

import json

from . import InputError, _store
from ._store import *  # noqa: F401,F403

_IDENTITY = {name: str for name in ("id", "key", "system", "variant", "sequence", "build", "mode", "kind", "seed", "repetition",
                                    "axis", "axis_value", "outcome", "detail", "started", "ended", "machine")}
_IDENTITY |= {"id": int, "seed": int, "repetition": int, "axis_value": float}


def columns(runs):
    """Runs as a dict of arrays: what identifies each run, its outcome, and its metrics by name (NaN: it has none)."""
    import numpy  # not before it is needed: it takes longer to load than all of this package

    result = {name: numpy.array([getattr(run, name) for run in runs], dtype=kind) for name, kind in _IDENTITY.items()}
    values = [run.metrics for run in runs]
    for name in sorted(set().union(*values)):
        result[name] = numpy.array([metrics.get(name, numpy.nan) for metrics in values])
    return result


def frame(runs):
    """`columns` as a pandas.DataFrame with one row per run. Needs pandas."""
    import pandas

    return pandas.DataFrame(columns(runs))


class Store(_store.Store):
    """A store of results, open for reading; it may be written at the same time."""

    def frame(self, **selection):
        """The runs that `runs(**selection)` returns as a pandas.DataFrame. Needs pandas."""
        return frame(self.runs(**selection))

    def columns(self, **selection):
        """The runs that `runs(**selection)` returns as a dict of arrays."""
        return columns(self.runs(**selection))

    def manifest(self, run):
        """Build, machine, config and command of a run; empty if it has none."""
        return json.loads(self.manifest_json(run) or "{}")

    def result(self, run):
        """The content of result.json; empty if the run has none."""
        return json.loads(self.attachment(run, "result") or b"{}")


__all__ = sorted(
    {"InputError", "Store", "columns", "frame"} | {name for name in vars(_store) if not name.startswith("_")}
)
