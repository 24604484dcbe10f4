# SPDX-License-Identifier: BSD-3-Clause
"""Stillpoint in Python: evaluation of trajectories, stores of results, datasets and the odometry.

The modules are loaded when they are first used:
  stillpoint.eval      trajectories, association, alignment, metrics and protocols
  stillpoint.store     stores of results, their statistics and comparisons
  stillpoint.run       a run of the odometry by the program
"""

import importlib.util

from ._eval import InputError

__all__ = ["InputError", "DataWarning", "eval", "run", "store"]

_MODULES = ("eval", "store")


class DataWarning(UserWarning):
    """A file was read, but rows were skipped or sorted, or something in it is assumed."""


def __getattr__(name):
    if name == "run":
        return importlib.import_module(".runs", __name__).run
    if name in _MODULES and importlib.util.find_spec(f"{__name__}._{name}"):
        return importlib.import_module("." + name, __name__)
    if name in _MODULES:
        raise AttributeError(f"stillpoint.{name} is not part of this installation; install python3-stillpoint")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__():
    return sorted(__all__)
