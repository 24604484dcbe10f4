# SPDX-License-Identifier: BSD-3-Clause
"""stillpoint.Odometry: the poses of a loop in Python are those of the program."""

import numpy as np
import pytest
import stillpoint
from run_test import output_of
from stillpoint import InputError, datasets, eval


@pytest.fixture(scope="module")
def stream(sequence):
    return datasets.open_sequence(sequence)


def track_all(stream, odometry):
    """The updates of all frames, and the features of the last one."""
    odometry.add_imu_samples(stream.imu_times_ns, stream.gyro, stream.accel)
    detector = stillpoint.RecordedDetector(stream.detections)
    updates = [odometry.track(frame, detector.detect(frame)) for frame in stream]
    return updates, odometry.features()


@pytest.fixture(scope="module")
def updates(stream):
    return track_all(stream, stillpoint.Odometry(stream.rig))[0]


@pytest.mark.parametrize("config, overrides", [(None, {}), ("vo", {}), (None, {"frontend.max_features": 100})])
def test_poses_are_those_of_the_program(stream, sequence, config, overrides):
    expected = stillpoint.run(sequence, config, overrides).trajectory
    updates, _ = track_all(stream, stillpoint.Odometry(stream.rig, config, overrides))
    located = [update for update in updates if update.is_located]
    assert [update.t_ns for update in located] == expected.times_ns.tolist() and len(located) > 20
    positions = np.array([update.position for update in located])
    quaternions = np.array([update.quaternion_xyzw for update in located])
    text = eval.format_tum(eval.Trajectory(expected.times_ns, positions, quaternions))  # the program writes nine decimals
    assert np.array_equal(eval.parse_tum(text).positions, expected.positions)


def test_the_example_feeds_what_the_program_runs(sequence, tmp_path):
    output = output_of("feed_odometry.py", sequence, tmp_path / "fed.tum")
    expected = stillpoint.run(sequence).trajectory
    fed = eval.read_trajectory(tmp_path / "fed.tum")
    assert np.array_equal(fed.positions, expected.positions) and len(output.splitlines()) == len(expected)


def test_repetitions_are_bit_identical(stream, updates):
    again, _ = track_all(stream, stillpoint.Odometry(stream.rig))
    assert all(np.array_equal(a.T_w_c, b.T_w_c) for a, b in zip(updates, again))


def test_updates_have_covariance_and_state(updates):
    last = updates[-1]
    assert last.status == "tracking" and last.covariance.shape == (15, 15)
    assert np.allclose(last.covariance, last.covariance.T) and (np.linalg.eigvalsh(last.covariance[:6, :6]) > 0).all()
    assert np.allclose(last.T_w_c[:3, 3], last.position) and last.velocity.shape == (3,)
    assert last.to_dict()["tracked_features"] == last.tracked_features > 50


def test_features_have_labels(stream):
    _, features = track_all(stream, stillpoint.Odometry(stream.rig))
    count = len(features["id"])
    assert features["pixel"].shape == (count, 2) and len(features["label"]) == count
    assert (np.diff(features["id"]) > 0).all() and (features["age"] >= 1).all()
    assert set(features["label"]) <= {"", "stable", "dynamic_object", "dynamic_motion"} and "stable" in features["label"]


@pytest.mark.parametrize(
    "tables, message",
    [
        ({"seeds": 1}, "seeds: is no key of the config"),
        ({"frontend": {"max_featurs": 1}}, "frontend.max_featurs: is no key of the config"),
        ({"frontend": {"max_features": "many"}}, "frontend.max_features: has a value of another type"),
        ({"frontend": {"max_features": -5}}, "frontend.max_features: is out of range"),
        ({"frontend": 3}, "frontend: has a value of another type"),
        ({"detector": {"kind": "magic"}}, "detector.kind: unknown value"),
    ],
)
def test_wrong_configs_are_rejected(stream, tables, message):
    with pytest.raises(InputError, match=message):
        stillpoint.Odometry(stream.rig, tables)


def test_configs_are_resolved_by_the_program():
    assert stillpoint.load_config("vo")["imu"]["enabled"] is False
    assert stillpoint.load_config(overrides={"seed": 7})["seed"] == 7
    with pytest.raises(InputError, match="did you mean"):
        stillpoint.load_config(overrides={"frontend.max_feature": 1})


def test_rigs_without_a_required_sensor_are_rejected(stream):
    with pytest.raises(InputError):
        stillpoint.Odometry(datasets.Rig(camera=stream.rig.camera))


def test_frames_of_another_size_or_time_are_rejected(stream):
    odometry = stillpoint.Odometry(stream.rig, "vo")
    odometry.track(stream[1])
    with pytest.raises(InputError):
        odometry.track(stream[0])
    with pytest.raises(InputError):
        odometry.track(datasets.Frame(stream[2].t_ns, np.zeros((10, 10), np.uint8)))


@pytest.mark.parametrize("gyro, accel", [(np.zeros((2, 3)), np.zeros((3, 3))), (np.zeros(3), np.zeros(3))])
def test_wrong_shapes_of_samples_are_rejected(stream, gyro, accel):
    with pytest.raises(InputError, match="has the shape"):
        stillpoint.Odometry(stream.rig).add_imu_samples(np.array([1, 2, 3]), gyro, accel)


def test_single_samples_are_counted(stream):
    odometry = stillpoint.Odometry(stream.rig)
    odometry.add_imu(5, [0, 0, 0], [0, 0, 9.81])
    odometry.add_imu(5, [0, 0, 0], [0, 0, 9.81])
    odometry.add_imu(6, [np.nan, 0, 0], [0, 0, 9.81])
    odometry.track(stream[0])
    assert odometry.imu_health[0] == 2
    assert odometry.needs_imu_until(10**9) > 10**9
