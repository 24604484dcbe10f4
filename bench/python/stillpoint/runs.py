# SPDX-License-Identifier: BSD-3-Clause
"""Runs of the odometry by the program `stillpoint`, in a process of its own."""

import dataclasses
import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from . import InputError
from .eval import Trajectory, read_trajectory

_ERROR = "stillpoint: error: "


@dataclasses.dataclass(frozen=True)
class Run:
    """What a run wrote. `result` is result.json: metrics, protocols and the report on the rig."""

    result: dict
    trajectory: Trajectory | None  #: poses T_w_c; None if the run located none
    folder: Path | None  #: with all files of the run; None: they were temporary


def program_path():
    """The program: $STILLPOINT_PROGRAM, that of the same build as the package, or the one in the path."""
    if os.environ.get("STILLPOINT_PROGRAM"):
        return os.environ["STILLPOINT_PROGRAM"]
    built = Path(__file__).resolve().parents[2] / "stillpoint"
    found = str(built) if os.access(built, os.X_OK) and built.is_file() else shutil.which("stillpoint")
    if found is None:
        raise InputError("stillpoint: the program is not in the path; install the package stillpoint, or set STILLPOINT_PROGRAM")
    return found


def _text(value):
    """A value as the program reads it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return json.dumps(value) if isinstance(value, (list, tuple)) else str(value)


def overriding(overrides):
    """The arguments that override config keys."""
    return [text for key, value in (overrides or {}).items() for text in ("--set", f"{key}={_text(value)}")]


def error_of(output):
    """The message of the program that failed."""
    errors = [line[len(_ERROR) :] for line in output.splitlines() if line.startswith(_ERROR)]
    return errors[-1] if errors else output.strip()


def run(sequence, config=None, overrides=None, *, out=None, options=()):
    """Runs the odometry on a sequence folder, bag or preset, and returns a Run.

    config: an embedded name or a TOML file; overrides: values by config key; out: folder for the files of the run, which are
    temporary without it; options: further options of `stillpoint run`, e.g. ["--max-frames", "100"].
    Raises InputError with the message of the program.
    """
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(out) if out is not None else Path(scratch) / "run"
        command = [program_path(), "run", str(sequence), "--out", str(folder), "--force", *map(str, options)]
        command += ["--config", str(config)] if config is not None else []
        command += overriding(overrides)
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
        if done.returncode == 130:
            raise KeyboardInterrupt
        if done.returncode == 2:
            raise InputError(error_of(done.stderr))
        path = folder / "result.json"
        if not path.exists():
            raise RuntimeError(f"{' '.join(command)}: exit status {done.returncode}: {done.stderr.strip()}")
        result = json.loads(path.read_text())
        poses = folder / "trajectory.tum"
        located = poses.exists() and any(line and not line.startswith("#") for line in poses.read_text().splitlines())
        return Run(result, read_trajectory(poses) if located else None, folder if out is not None else None)
