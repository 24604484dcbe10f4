# SPDX-License-Identifier: BSD-3-Clause
"""stillpoint.synth renders what the program renders."""

import filecmp
import os

import numpy as np
import pytest
from conftest import run_program
from stillpoint import InputError, datasets, synth

SETTINGS = {"seconds": 0.2, "width": 96, "height": 72, "walkers": 1, "labels": True, "seed": 3}
OPTIONS = ["--seconds", 0.2, "--width", 96, "--height", 72, "--people", 1, "--labels", "--seed", 3]


@pytest.fixture(scope="module")
def rendered(tmp_path_factory):
    """The folder of a rendered sequence, and the sequence."""
    folder = tmp_path_factory.mktemp("synth") / "walk"
    return folder, synth.render("walking_xyz", out=folder, **SETTINGS)


def files_of(folder):
    return sorted(os.path.relpath(os.path.join(path, name), folder) for path, _, names in os.walk(folder) for name in names)


def test_files_are_those_of_the_program(rendered, tmp_path):
    folder, _ = rendered
    assert run_program("data", "synth", "walking_xyz", *OPTIONS, "--out", tmp_path / "walk").returncode == 0
    files = files_of(folder)
    assert files == files_of(tmp_path / "walk") and len(files) > 20
    assert filecmp.cmpfiles(folder, tmp_path / "walk", files, shallow=False) == (files, [], [])


def test_frames_are_arrays(rendered):
    _, sequence = rendered
    assert len(sequence) == 6
    frame = sequence[2]
    assert frame.color.shape == (72, 96, 3) and frame.gray.shape == frame.depth.shape == (72, 96)
    assert frame.depth.dtype == np.uint16 and frame.gray.std() > 5
    objects, speed = sequence.motion_labels(2)
    assert objects.shape == speed.shape == (72, 96)
    assert len(sequence.camera_truth) >= 6 and sequence.rig.camera.fx == pytest.approx(535.0 * 96 / 640)


def test_the_number_of_threads_does_not_change_the_bits(rendered, tmp_path):
    other = synth.render(synth.preset("walking_xyz", **SETTINGS), tmp_path / "one", threads=1)
    for a, b in zip(rendered[1], other, strict=True):
        assert np.array_equal(a.color, b.color) and np.array_equal(a.depth, b.depth)


def test_another_seed_is_another_sequence(rendered, tmp_path):
    other = synth.render("walking_xyz", tmp_path / "seed", **{**SETTINGS, "seed": 4})
    assert not np.array_equal(other[0].color, rendered[1][0].color)


def test_the_cache_is_that_of_the_program(tmp_path, monkeypatch):
    monkeypatch.setenv("STILLPOINT_CACHE", str(tmp_path))
    sequence = synth.render("walking_xyz", **SETTINGS)
    printed = run_program("data", "synth", "walking_xyz", *OPTIONS).stdout.strip()
    assert printed.startswith(str(tmp_path)) and synth.preset("walking_xyz", **SETTINGS).key in printed
    assert datasets.open_sequence(printed).frame_times_ns.tolist() == sequence.frame_times_ns.tolist()


def test_requests_have_the_values_of_their_preset():
    market = synth.preset("market")
    assert market.walkers > 0 and market.key != synth.preset("market", seed=2).key
    market.color.read_noise = 0.01
    assert market.color.read_noise == 0.01 and market.key != synth.preset("market").key
    assert {"market", "walking_xyz", "corridor_empty"} <= set(synth.preset_names())


@pytest.mark.parametrize("settings, words", [({"seconds": -1.0}, "seconds"), ({"width": 0}, "width"), ({"threads": -1}, "threads")])
def test_settings_out_of_range_are_input_errors(tmp_path, settings, words):
    with pytest.raises(InputError, match=words):
        synth.render("walking_xyz", tmp_path / "x", **settings)
    assert not (tmp_path / "x").exists()


def test_unknown_presets_and_fields_are_named(tmp_path):
    with pytest.raises(InputError, match="no_such_preset"):
        synth.render("no_such_preset", tmp_path / "x")
    with pytest.raises(TypeError, match="colour"):
        synth.render("walking_xyz", tmp_path / "x", colour=1)


def test_an_existing_folder_is_not_replaced(rendered):
    folder, _ = rendered
    with pytest.raises(InputError, match="exists"):
        synth.render("walking_xyz", out=folder, **SETTINGS)
