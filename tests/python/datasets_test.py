# SPDX-License-Identifier: BSD-3-Clause
"""stillpoint.datasets: sequences as arrays."""

import numpy as np
import pytest
from conftest import run_program
from stillpoint import InputError, datasets, eval


@pytest.fixture(scope="module")
def stream(sequence):
    return datasets.open_sequence(sequence)


def test_frames_are_those_of_the_list(stream, sequence):
    listed = [line.split()[0] for line in (sequence / "color.txt").read_text().splitlines()]
    assert [f"{t_ns / 10**9:.6f}" for t_ns in stream.frame_times_ns.tolist()] == listed
    assert [frame.t_ns for frame in stream] == stream.frame_times_ns.tolist()
    assert len(stream) == len(list(stream)) == 45
    assert stream[-1].id == 44 and stream[0].id == 0


@pytest.mark.parametrize("name, shape, kind", [("gray", (240, 320), np.uint8), ("color", (240, 320, 3), np.uint8),
                                               ("depth", (240, 320), np.uint16)])
def test_images_are_read_only_views(stream, name, shape, kind):
    image = getattr(stream[3], name)
    assert image.shape == shape and image.dtype == kind and image.std() > 0
    assert not image.flags.owndata and not image.flags.writeable


def test_images_outlive_their_frame_and_sequence(sequence):
    gray = datasets.open_sequence(sequence)[0].gray
    assert np.array_equal(gray, datasets.open_sequence(sequence)[0].gray)


@pytest.mark.parametrize("index", [45, -46, 1000])
def test_frames_that_do_not_exist_are_index_errors(stream, index):
    with pytest.raises(IndexError):
        stream[index]


def test_inertial_samples_are_views_and_increase(stream):
    count = len(stream.imu_times_ns)
    assert count > 100 and stream.gyro.shape == stream.accel.shape == (count, 3)
    assert not stream.gyro.flags.owndata and (np.diff(stream.imu_times_ns) > 0).all()
    assert abs(np.linalg.norm(stream.accel.mean(axis=0)) - 9.81) < 2.0


def test_rig_has_the_calibration(stream):
    camera = stream.rig.camera
    assert (camera.width, camera.height, camera.fx) == (320, 240, 260.0)
    assert stream.rig.has_imu and stream.rig.T_b_c.shape == (4, 4)
    assert stream.rig.imu_noise.gyro_noise > 0


def test_truth_of_the_camera_is_moved_from_the_stated_frame(stream):
    assert len(stream.camera_truth) == len(stream.ground_truth) > 0
    assert stream.camera_truth.frame == "camera"


def test_boxes_are_recorded(stream):
    boxes = [box for detections in stream.detections for box in detections.boxes]
    assert boxes and {name for name, _, _ in boxes} == {"person"}
    again = datasets.DetectionSet(5, boxes[:1])
    assert again.t_ns == 5 and again.boxes == boxes[:1]


@pytest.mark.parametrize("name", ["copy.bag", "copy.mcap"])
def test_a_written_bag_has_the_same_pixels_and_samples(stream, tmp_path, name):
    stream.write_bag(tmp_path / name)
    copy = datasets.open_sequence(tmp_path / name)
    assert np.array_equal(copy.gyro, stream.gyro) and np.array_equal(copy.frame_times_ns, stream.frame_times_ns)
    assert np.array_equal(copy[7].color, stream[7].color) and np.array_equal(copy[7].depth, stream[7].depth)
    truth = eval.read_trajectory(f"{tmp_path / name}:/ground_truth")
    assert np.allclose(truth.positions, stream.camera_truth.positions, atol=1e-12)
    with pytest.raises(InputError, match="exist"):
        stream.write_bag(tmp_path / name)


def test_a_written_tum_sequence_is_read_again(stream, tmp_path):
    stream.write_tum(tmp_path / "tum")
    copy = datasets.open_sequence(tmp_path / "tum", "tum")
    assert copy.format == "tum" and len(copy) == 45 and np.array_equal(copy[2].gray, stream[2].gray)


def test_topics_that_do_not_exist_are_input_errors(stream, tmp_path):
    stream.write_bag(tmp_path / "a.bag")
    done = run_program("eval", f"{tmp_path}/a.bag:/nothing", f"{tmp_path}/a.bag:/nothing")
    with pytest.raises(InputError) as error:
        eval.read_trajectory(f"{tmp_path}/a.bag:/nothing")
    assert done.returncode == 2 and str(error.value) in done.stderr


@pytest.mark.parametrize("arguments, message", [({"path": "/no/such/folder"}, "/no/such/folder"), ({"format": "tumm"}, "tumm"),
                                                ({"rig": "/no/rig.toml"}, "/no/rig.toml")])
def test_what_is_no_sequence_is_an_input_error(sequence, arguments, message):
    with pytest.raises(InputError, match=message):
        datasets.open_sequence(**{"path": sequence, **arguments})


def test_formats_are_listed():
    assert {"tum", "openloris", "euroc"} <= set(datasets.format_names().split(", "))


@pytest.mark.parametrize(
    "images, message",
    [
        ({"gray": np.zeros((4, 4))}, r"gray: is no array \[height, width\] of uint8"),
        ({"gray": np.zeros((4, 4, 3), np.uint8)}, r"gray: is no array"),
        ({"depth": np.zeros((4, 4), np.float32)}, r"depth: is no array \[height, width\] of uint16"),
        ({"color": np.zeros((4, 4), np.uint8)}, r"color: is no array \[height, width, 3\] of uint8"),
    ],
)
def test_wrong_images_are_rejected(images, message):
    with pytest.raises(InputError, match=message):
        datasets.Frame(0, **{"gray": np.zeros((4, 4), np.uint8), **images})


def test_frames_of_arrays_have_their_pixels():
    gray = np.arange(24, dtype=np.uint8).reshape(4, 6)
    frame = datasets.Frame(7, gray[:, ::2], gray[:, ::2].astype(np.uint16) * 1000, id=3)
    assert np.array_equal(frame.gray, gray[:, ::2]) and frame.depth[3, 2] == 22000 and frame.color is None
    assert (frame.t_ns, frame.id) == (7, 3)
