# SPDX-License-Identifier: BSD-3-Clause
"""Evaluation of trajectories: the functions that the program `stillpoint eval` calls, with the same results to the bit.

Poses are T_w_f, from the body frame f to a world w; lengths are in m, angles in deg unless named otherwise, stamps are
int64 nanoseconds, quaternions are (x, y, z, w). A function that has no result for its data returns None.
"""

import importlib.util
import warnings

from . import DataWarning, InputError, _eval
from ._eval import *  # noqa: F401,F403
from ._eval import ProtocolOptions, Trajectory, evaluate_protocol, load_trajectory, require_overlap


def _load_bag_topic(path):
    """What BAG:/TOPIC has; None for other paths, and without stillpoint.datasets, which reads bags."""
    if ":" not in path or importlib.util.find_spec("stillpoint._datasets") is None:
        return None
    return importlib.import_module("stillpoint._datasets").load_bag_trajectory(path)


def read_trajectory(path, format=None, times="", sequence=0):
    """Reads a trajectory of any format of `load_trajectory`, or the topic of a bag ("run.bag:/odom"), and warns of rows that were
    skipped or sorted.

    Raises InputError for malformed input.
    """
    loaded = _load_bag_topic(str(path)) or load_trajectory(path, format, times, sequence)
    for repair in loaded.repairs:
        warnings.warn(f"{path}: {repair}", DataWarning, stacklevel=2)
    if loaded.order_is_assumed:
        warnings.warn(f"{path}: no header names the columns; the order of the quaternions is assumed", DataWarning,
                      stacklevel=2)
    return loaded.trajectory


def evaluate(protocol, gt, est, **options):
    """Evaluates an estimate with a protocol of `protocols`; `options` are the fields of ProtocolOptions.

    Raises InputError if the trajectories do not overlap in time, for an unknown protocol, and where the data do not
    determine what all errors depend on.
    """
    values = ProtocolOptions(**options)
    if len(gt) and len(est):
        require_overlap(gt, est, values.offset_s, "est")
    return evaluate_protocol(protocol, gt, est, values)


__all__ = sorted(
    ["InputError", "read_trajectory", "evaluate"]
    + [name for name in vars(_eval) if not name.startswith("_") and name != "InputError"]
)
