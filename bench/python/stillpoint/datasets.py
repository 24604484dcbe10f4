# SPDX-License-Identifier: BSD-3-Clause
"""Sequences of every format that the program reads, and bags: frames, inertial samples, boxes and true poses as arrays.

    sequence = open_sequence("walking_xyz")
    for frame in sequence:                     # decoded one by one
        frame.t_ns, frame.gray, frame.depth    # uint8 [h, w], uint16 [h, w]; views, no copies
    sequence.imu_times_ns, sequence.gyro       # int64 [m], [m, 3] rad/s
"""

from . import InputError, _datasets
from ._datasets import *  # noqa: F401,F403

__all__ = sorted({"InputError"} | {name for name in vars(_datasets) if not name.startswith("_")})
