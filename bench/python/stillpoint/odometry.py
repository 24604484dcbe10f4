# SPDX-License-Identifier: BSD-3-Clause
"""The odometry for a program with its own sensor loop.

    odometry = stillpoint.Odometry(sequence.rig, "stillpoint")
    odometry.add_imu_samples(times_ns, gyro, accel)     # up to odometry.needs_imu_until(frame.t_ns)
    update = odometry.track(frame, detections)
    update.status, update.T_w_c, update.covariance, odometry.features()["label"]
"""

from . import InputError, _odometry
from ._odometry import OdometryUpdate, RecordedDetector

__all__ = ["InputError", "Odometry", "OdometryUpdate", "RecordedDetector", "load_config"]


def load_config(config=None, overrides=None):
    """The tables of a config: an embedded name or a TOML file, None for the default, with values by key that override it.

    The program resolves it. Raises InputError with its message, e.g. for an unknown key.
    """
    import subprocess  # here, as they take longer to load than the odometry
    import tomllib

    from .runs import error_of, overriding, program_path

    command = [program_path(), "config", "show", *(["--config", str(config)] if config is not None else [])]
    done = subprocess.run(command + overriding(overrides), capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise InputError(error_of(done.stderr))
    return tomllib.loads(done.stdout)


class Odometry(_odometry.Odometry):
    """Odometry of a rig. One thread at a time may use an object; the same inputs give bit-identical results."""

    def __init__(self, rig, config=None, overrides=None):
        """rig: Rig, e.g. of a Sequence; config: as of `load_config`, or tables; overrides: values by config key.

        Raises InputError if the rig lacks a sensor that the config requires.
        """
        tables = config if isinstance(config, dict) else load_config(config, overrides)
        if isinstance(config, dict) and overrides:
            raise InputError("overrides: apply to a named config; change the tables instead")
        super().__init__(tables, rig)
