# SPDX-License-Identifier: BSD-3-Clause
"""Trajectories, their arrays, association and alignment."""

import threading
import time
import warnings

import numpy as np
import pytest
from conftest import estimate_of, quaternions_about, spiral, trajectory
from stillpoint import DataWarning, InputError
from stillpoint import eval as sp

IDENTITY = [0.0, 0.0, 0.0, 1.0]


def line(count=5):
    return sp.Trajectory(np.arange(count) * 10**9, np.outer(np.arange(count), [1.0, 0.0, 0.0]), np.tile(IDENTITY, (count, 1)))


@pytest.mark.parametrize("name, shape", [("times_ns", (600,)), ("positions", (600, 3)), ("quaternions_xyzw", (600, 4))])
def test_arrays_are_read_only_views_of_one_memory(gt, name, shape):
    array = getattr(gt, name)
    assert array.shape == shape
    assert not array.flags.owndata and not array.flags.writeable
    address = array.__array_interface__["data"][0]
    assert getattr(gt, name).__array_interface__["data"][0] == address


def test_a_view_keeps_its_trajectory_alive():
    positions = line(1000).positions
    other = [line(1000) for _ in range(10)]
    assert positions[:, 0].sum() == sum(range(1000)) and len(other) == 10


def test_round_trip_of_arrays_is_exact(gt):
    again = sp.Trajectory(gt.times_ns, gt.positions, gt.quaternions_xyzw, "imu")
    assert np.array_equal(again.times_ns, gt.times_ns)
    assert np.array_equal(again.positions, gt.positions)
    assert np.array_equal(again.quaternions_xyzw, gt.quaternions_xyzw)
    assert again.frame == "imu" and "600 poses" in repr(again)


@pytest.mark.parametrize("kind", [np.float32, np.float64, np.int64])
def test_positions_of_any_number_type_are_taken(kind):
    poses = sp.Trajectory(np.arange(3), np.ones((3, 3), kind), np.tile(IDENTITY, (3, 1)))
    assert poses.positions.tolist() == [[1.0, 1.0, 1.0]] * 3


@pytest.mark.parametrize("kind", [np.int32, np.int64, np.uint64])
def test_stamps_of_integer_types_are_taken(kind):
    assert sp.Trajectory(np.arange(3, dtype=kind), np.ones((3, 3)), np.tile(IDENTITY, (3, 1))).times_ns.tolist() == [0, 1, 2]


@pytest.mark.parametrize("unit", ["ns", "us", "s"])
def test_stamps_of_times_are_taken_to_the_nanosecond(unit):
    times = np.array([1_700_000_000, 1_700_000_001]).astype("datetime64[s]").astype(f"datetime64[{unit}]")
    poses = sp.Trajectory(times, np.ones((2, 3)), np.tile(IDENTITY, (2, 1)))
    assert poses.times_ns.tolist() == [1_700_000_000 * 10**9, 1_700_000_001 * 10**9]


def test_columns_of_pandas_and_lists_are_taken():
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame({"t": [5, 6], "x": [0.0, 1.0], "y": 0.0, "z": 0.0, "qx": 0.0, "qy": 0.0, "qz": 0.0, "qw": 1.0})
    table.index = [7, 3]
    poses = sp.Trajectory(table["t"], table[["x", "y", "z"]], table[["qx", "qy", "qz", "qw"]])
    assert poses.times_ns.tolist() == [5, 6] and poses.positions[1, 0] == 1.0
    times = pandas.to_datetime(table["t"], unit="ns")
    assert sp.Trajectory(times, table[["x", "y", "z"]], table[["qx", "qy", "qz", "qw"]]).times_ns.tolist() == [5, 6]
    assert len(sp.Trajectory([1, 2], [[0, 0, 0]] * 2, [IDENTITY] * 2)) == 2


@pytest.mark.parametrize(
    "times, problem",
    [
        (np.array([0, 2**63], np.uint64), r"times_ns\[1\]: exceeds the range of int64"),
        (np.array(["2026-01-01", "NaT"], "datetime64[ns]"), r"times_ns\[1\]: is no time"),
        (["a", "b"], "no array of integers or times"),
        (None, "times_ns: has the shape"),
    ],
)
def test_stamps_that_are_none_are_named(times, problem):
    with pytest.raises(InputError, match=problem):
        sp.Trajectory(times, np.ones((2, 3)), np.tile(IDENTITY, (2, 1)))


def test_strided_and_reversed_arrays_are_read_as_they_are_indexed():
    positions = np.arange(30.0).reshape(10, 3)[::-2]
    assert np.array_equal(sp.Trajectory(np.arange(5), positions, np.tile(IDENTITY, (5, 1))).positions, positions)


@pytest.mark.parametrize(
    "change, message",
    [
        ({"times_ns": np.array([0.0, 1.0])}, r"times_ns: is no array of integers.*from_seconds"),
        ({"times_ns": np.array([0, 1, 2])}, r"positions: has the shape \(2, 3\); expected \(3, 3\)"),
        ({"times_ns": np.array([[0, 1]])}, r"times_ns: has the shape \(1, 2\); expected \(n\)"),
        ({"times_ns": np.array([1, 1])}, r"times_ns\[1\]: is not later"),
        ({"times_ns": np.array([2, 1])}, r"times_ns\[1\]: is not later"),
        ({"positions": np.zeros((2, 2))}, r"positions: has the shape \(2, 2\)"),
        ({"positions": np.array([[0, 0, 0], [0, np.nan, 0]])}, r"positions\[1\]: is not finite"),
        ({"positions": np.array([[np.inf, 0, 0], [0, 0, 0]])}, r"positions\[0\]: is not finite"),
        ({"quaternions_xyzw": np.zeros((2, 4))}, r"quaternions_xyzw\[0\]: has norm 0"),
        ({"quaternions_xyzw": np.full((2, 4), 1.0)}, r"quaternions_xyzw\[0\]: has norm 2"),
        ({"quaternions_xyzw": np.full((2, 4), np.nan)}, r"quaternions_xyzw\[0\]: has norm"),
        ({"quaternions_xyzw": np.zeros((2, 3))}, r"quaternions_xyzw: has the shape \(2, 3\); expected \(2, 4\)"),
    ],
)
def test_wrong_arrays_are_rejected(change, message):
    arrays = {"times_ns": np.array([0, 1]), "positions": np.zeros((2, 3)), "quaternions_xyzw": np.tile(IDENTITY, (2, 1))}
    with pytest.raises(InputError, match=message):
        sp.Trajectory(**{**arrays, **change})


@pytest.mark.parametrize("times", [[np.nan, 1.0], [0.0, 1e19], [0.0, np.inf]])
def test_times_that_are_no_seconds_are_rejected(times):
    with pytest.raises(InputError, match="is no time in seconds"):
        sp.Trajectory.from_seconds(times, np.zeros((2, 3)), np.tile(IDENTITY, (2, 1)))


def test_input_error_is_a_value_error_of_the_package():
    assert issubclass(InputError, ValueError)
    assert InputError.__module__ == "stillpoint"


def test_empty_trajectories_have_empty_arrays():
    empty = sp.Trajectory(np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros((0, 4)))
    assert len(empty) == 0 and empty.positions.shape == (0, 3) and empty.times_ns.shape == (0,)
    assert sp.score(empty, empty).ate is None


@pytest.mark.parametrize(
    "text, message",
    [
        ("1 0 0 0 0 0 0\n", "text:1: "),
        ("1 0 0 0 0 0 0 1\nx 0 0 0 0 0 0 1\n", "text:2: "),
        ("1 0 0 0 0 0 0 5\n", "the quaternion has norm 5"),
        ("", "text: "),
    ],
)
def test_malformed_text_is_an_input_error_with_its_line(text, message):
    with pytest.raises(InputError, match=message):
        sp.parse_tum(text)


@pytest.mark.parametrize("name", ["missing.tum", "folder"])
def test_unreadable_files_are_input_errors(tmp_path, name):
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match=name):
        sp.read_trajectory(tmp_path / name)


def test_repaired_rows_are_warned_of(tmp_path):
    path = tmp_path / "e.tum"
    path.write_text("1 0 0 0 0 0 0 1\n3 0 0 0 0 0 0 1\n2.5 0 0 0 0 0 0 1\n4 nan 0 0 0 0 0 1\n")
    with pytest.warns(DataWarning) as caught:
        assert len(sp.read_trajectory(path)) == 3
    assert len(caught) == 2 and all(str(warning.message).startswith(str(path)) for warning in caught)


def test_clean_files_are_not_warned_of(folder):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sp.read_trajectory(folder / "gt.tum")


@pytest.mark.parametrize("format", ["tum", "euroc"])
def test_formats_are_detected_or_given(tmp_path, format):
    path = tmp_path / "poses.csv"
    path.write_text({"tum": "1.5 1 2 3 0 0 0 1\n2.5 1 2 3 0 0 0 1\n",
                     "euroc": "#timestamp [ns], p_x, p_y, p_z, q_w, q_x, q_y, q_z\n1500000000,1,2,3,1,0,0,0\n"}[format])
    for given in (None, format):
        poses = sp.read_trajectory(path, given)
        assert poses.times_ns[0] == 1500000000 and poses.positions[0].tolist() == [1, 2, 3]
        assert poses.quaternions_xyzw[0].tolist() == IDENTITY


def test_an_unknown_format_is_rejected(folder):
    with pytest.raises(InputError, match="format: unknown value"):
        sp.read_trajectory(folder / "gt.tum", "tumm")


def test_text_of_a_trajectory_is_read_again(gt, tmp_path):
    sp.write_tum(gt, tmp_path / "t.tum")
    assert (tmp_path / "t.tum").read_text() == sp.format_tum(gt)
    assert np.array_equal(sp.parse_tum(sp.format_tum(gt)).times_ns, gt.times_ns)


@pytest.mark.parametrize("associate", [sp.associate_tum, sp.associate_evo])
def test_association_is_by_the_closest_stamps(gt, est, associate):
    pairs = associate(gt, est)
    assert pairs.dtype == np.int64 and pairs.shape == (len(est), 2)
    assert np.array_equal(pairs[:, 0], pairs[:, 1])
    assert len(associate(gt, est, max_difference_s=0.001)) == 0
    assert len(associate(gt, est, max_difference_s=0.001, offset_s=-0.004)) == len(est)


def test_interpolated_association_has_the_fraction_of_time(gt, est):
    pairs, fractions = sp.associate_interpolated(gt, est, 0.11)
    later = gt.times_ns[pairs[:, 0] + 1] - gt.times_ns[pairs[:, 0]]
    assert np.allclose(fractions, (est.times_ns[pairs[:, 1]] - gt.times_ns[pairs[:, 0]]) / later, atol=1e-9)
    matches = sp.PoseMatches(gt, est, pairs, fractions)
    a, b = gt.positions[pairs[:, 0]], gt.positions[pairs[:, 0] + 1]
    assert np.allclose(matches.gt_positions, a + fractions[:, None] * (b - a), atol=1e-12)


@pytest.mark.parametrize("pairs", [[[0, 600]], [[-1, 0]], [[0, 0], [700, 1]]])
def test_matches_of_missing_poses_are_rejected(gt, est, pairs):
    with pytest.raises(InputError, match="of 600 poses"):
        sp.PoseMatches(gt, est, np.array(pairs))


def test_matches_keep_their_trajectories_alive():
    matches = sp.PoseMatches(line(100), line(100), np.repeat(np.arange(100)[:, None], 2, axis=1))
    other = [line(100) for _ in range(10)]
    assert matches.gt_positions[:, 0].tolist() == list(range(100)) and len(other) == 10


@pytest.mark.parametrize("kind, scale", [("se3", 1.0), ("sim3", 2.0), ("yaw", 1.0), ("first_pose", 1.0), ("none", 1.0)])
def test_alignment_recovers_the_transform(gt, kind, scale):
    transform = sp.Similarity([1.0, -2.0, 0.5], quaternions_about([0, 0, 1], [0.7])[0], 1.0)
    est = transform * gt
    if scale != 1.0:
        est = sp.Trajectory(gt.times_ns, est.positions / scale, est.quaternions_xyzw)
    matches = sp.PoseMatches(gt, est, sp.associate_tum(gt, est))
    fitted = sp.align(matches, kind)
    aligned = fitted.S_w_v * est.positions
    if kind == "none":
        assert np.array_equal(aligned, est.positions)
    else:
        assert np.allclose(aligned, gt.positions, atol=1e-9)
        assert np.isclose(fitted.S_w_v.scale, scale)
        translation, rotation = sp.ate_errors(matches, fitted.S_w_v)
        assert translation.max() < 1e-9 and rotation.max() < 1e-6
    assert fitted.determined or kind in ("none", "first_pose")


def test_alignment_is_least_squares(gt, est):
    matches = sp.PoseMatches(gt, est, sp.associate_tum(gt, est))
    a, b = matches.gt_positions, matches.est_positions
    u, _, vt = np.linalg.svd((a - a.mean(0)).T @ (b - b.mean(0)))
    rotation = u @ np.diag([1, 1, np.sign(np.linalg.det(u @ vt))]) @ vt
    assert np.allclose(sp.align(matches).S_w_v.rotation, rotation, atol=1e-12)


def test_move_to_frame_applies_the_transform_on_the_right(gt):
    T_f_g = np.eye(4)
    T_f_g[:3, 3] = [0.1, 0.2, 0.3]
    assert np.allclose(sp.move_to_frame(gt, T_f_g, "g").matrices(), gt.matrices() @ T_f_g, atol=1e-12)
    with pytest.raises(InputError, match="no rigid transform"):
        sp.move_to_frame(gt, 2.0 * T_f_g)


def test_the_gil_is_released_while_computing():
    truth = spiral(60000)
    gt, est = trajectory(truth), trajectory(estimate_of(truth, 1))
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0)

    thread = threading.Thread(target=count)
    thread.start()
    try:
        before = counted[0]
        sp.rpe(gt, est)
        during = counted[0] - before
    finally:
        stop.set()
        thread.join()
    assert during > 0
