# SPDX-License-Identifier: BSD-3-Clause
"""Stillpoint in Python: evaluation of trajectories, stores of results, datasets and the odometry.

The modules are loaded when they are first used:
  stillpoint.eval      trajectories, association, alignment, metrics and protocols
"""

import importlib

from ._eval import InputError

__all__ = ["InputError", "DataWarning", "eval"]

_MODULES = ("eval",)


class DataWarning(UserWarning):
    """A file was read, but rows were skipped or sorted, or something in it is assumed."""


def __getattr__(name):
    if name in _MODULES:
        return importlib.import_module("." + name, __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__():
    return sorted(__all__)
