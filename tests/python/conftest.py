# SPDX-License-Identifier: BSD-3-Clause
"""Trajectories that the tests write, and the program that the package is compared with."""

import json
import os
import shutil
import subprocess

import numpy as np
import pytest
from stillpoint import eval as sp

PROGRAM = os.environ["STILLPOINT_PROGRAM"]


def run_program(*arguments):
    """The finished process of the program."""
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)


def program_json(*arguments):
    """What the program prints as JSON."""
    done = run_program(*arguments)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def quaternions_about(axis, angles):
    """Rotations (x, y, z, w) about a unit vector."""
    half = 0.5 * np.asarray(angles)
    return np.column_stack([np.outer(np.sin(half), axis), np.cos(half)])


def product(a, b):
    """Products of rotations (x, y, z, w)."""
    a, b = np.broadcast_arrays(a, b)
    vector = a[:, 3:] * b[:, :3] + b[:, 3:] * a[:, :3] + np.cross(a[:, :3], b[:, :3])
    return np.column_stack([vector, a[:, 3] * b[:, 3] - np.sum(a[:, :3] * b[:, :3], axis=1)])


def spiral(count=600, rate_hz=30.0, start_s=1.7e9):
    """A path in three dimensions with turns: times [s], positions, quaternions."""
    t = np.arange(count) / rate_hz
    positions = np.column_stack([2.0 * np.cos(0.7 * t), 1.5 * np.sin(0.9 * t), 0.05 * t + 0.2 * np.sin(1.3 * t)])
    quaternions = quaternions_about([0.6, 0.0, 0.8], 0.8 * np.sin(0.5 * t) + 0.3 * t)
    return start_s + t, positions, quaternions


def estimate_of(truth, seed, noise_m=0.02, gap=None):
    """The truth with noise, drift and another world; frames in `gap` (from, to) are missing."""
    times, positions, quaternions = truth
    random = np.random.default_rng(seed)
    drift = np.cumsum(random.normal(0.0, 0.002, positions.shape), axis=0)
    world = quaternions_about([0.0, 0.0, 1.0], [-0.5 * np.pi])  # (x, y, z) -> (y, -x, z)
    moved = positions[:, [1, 0, 2]] * [1, -1, 1] + [3.0, -1.0, 0.5] + drift + random.normal(0, noise_m, positions.shape)
    turned = product(world, product(quaternions, quaternions_about([1.0, 0.0, 0.0], random.normal(0, 0.01, len(times)))))
    used = np.ones(len(times), bool)
    if gap:
        used[gap[0] : gap[1]] = False
    return times[used] + 0.004, moved[used], turned[used]


def trajectory(columns):
    return sp.Trajectory.from_seconds(*columns)


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """Files gt.tum, a.tum (noise) and b.tum (a gap)."""
    path = tmp_path_factory.mktemp("trajectories")
    truth = spiral()
    sp.write_tum(trajectory(truth), path / "gt.tum")
    sp.write_tum(trajectory(estimate_of(truth, 1)), path / "a.tum")
    sp.write_tum(trajectory(estimate_of(truth, 2, 0.05, (200, 330))), path / "b.tum")
    return path


@pytest.fixture(scope="session")
def gt(folder):
    return sp.read_trajectory(folder / "gt.tum")


@pytest.fixture(scope="session")
def est(folder):
    return sp.read_trajectory(folder / "a.tum")


PLAN = """
title = "Python test"
variants = ["stillpoint", "vo"]
seeds = [1, 2]
ablation_base = "stillpoint"
[recorded]
sequences = ["walk"]
"""


@pytest.fixture(scope="session")
def sequence(tmp_path_factory):
    """A rendered sequence of 45 frames with a walking person."""
    path = tmp_path_factory.mktemp("data") / "walk"
    done = run_program("data", "synth", "walking_xyz", "--seconds", 1.5, "--width", 320, "--height", 240, "--focal", 260,
                       "--people", 1, "--out", path)
    assert done.returncode == 0, done.stderr
    return path


TABLES = """
title = "Tables"
variants = ["vo", "vo+wo_mcc"]
ablation_base = "vo"
repetitions = 2
max_frames = 8
faults = ["none", "blank:start=0.1,duration=0.1"]
expected = ["survive", "survive"]
[recorded]
sequences = ["walking_xyz"]
[sweep]
frontend.max_features = [60, 90]
"""


def execute(folder, sequence, plan):
    """The store of a plan with a rendered sequence; plan and store are in a folder."""
    (folder / "plan.toml").write_text(plan)
    done = subprocess.run([PROGRAM, "bench", folder / "plan.toml", "--store", folder / "runs.sqlite", "--out", folder / "out"],
                          capture_output=True, text=True, check=False, env={**os.environ, "STILLPOINT_DATA": str(sequence.parent)})
    assert done.returncode in (0, 1), done.stderr
    return folder / "runs.sqlite"


@pytest.fixture(scope="session")
def tables_store(tmp_path_factory, sequence):
    """A store with repetitions, a sweep and a fault; runs of eight frames. faults/plan.toml is for `stats faults`, which has the
    rendered sequences of a plan."""
    folder = tmp_path_factory.mktemp("tables")
    for name in ("data", "faults"):
        (folder / name).mkdir()
    shutil.copytree(sequence, folder / "data" / "walking_xyz")
    (folder / "faults" / "plan.toml").write_text(TABLES.replace("[recorded]", "[rendered]"))
    return execute(folder, folder / "data" / "walking_xyz", TABLES)


@pytest.fixture(scope="session")
def store_file(tmp_path_factory, sequence):
    """A store with four runs of the odometry."""
    return execute(tmp_path_factory.mktemp("store"), sequence, PLAN)
