# SPDX-License-Identifier: BSD-3-Clause
"""Stillpoint in Python: evaluation of trajectories, stores of results, datasets and the odometry.

The modules are loaded when they are first used:
  stillpoint.eval      trajectories, association, alignment, metrics and protocols
  stillpoint.store     stores of results, their statistics and comparisons
  stillpoint.datasets  sequences of any format: frames, inertial samples and truth as arrays
  stillpoint.synth     rendered sequences with exact ground truth
  stillpoint.Odometry  the odometry, fed by a loop of yours
  stillpoint.run       a run of the odometry by the program
"""

import importlib.util

from ._eval import InputError

_MODULES = ("datasets", "eval", "store", "synth")
_FUNCTIONS = {"Odometry": "odometry", "RecordedDetector": "odometry", "load_config": "odometry", "run": "runs"}

__all__ = ["InputError", "DataWarning", *_MODULES, *_FUNCTIONS]


class DataWarning(UserWarning):
    """A file was read, but rows were skipped or sorted, or something in it is assumed."""


def __getattr__(name):
    module = _FUNCTIONS.get(name, name if name in _MODULES else None)
    if module is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if module != "runs" and importlib.util.find_spec(f"{__name__}._{module}") is None:
        raise AttributeError(f"stillpoint.{name} is not part of this installation; build it, see bench/python/README.md")
    loaded = importlib.import_module("." + module, __name__)
    return getattr(loaded, name) if name in _FUNCTIONS else loaded


def __dir__():
    return sorted(__all__)
