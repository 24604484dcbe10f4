# SPDX-License-Identifier: BSD-3-Clause
"""stillpoint.run executes the program; the examples run."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import stillpoint
from conftest import run_program
from stillpoint import InputError, eval

EXAMPLES = Path(__file__).resolve().parents[2] / "core" / "examples" / "python"


@pytest.fixture(scope="module")
def run(sequence, tmp_path_factory):
    return stillpoint.run(sequence, overrides={"frontend.max_features": 120}, out=tmp_path_factory.mktemp("run") / "out")


def test_run_gives_the_result_and_the_trajectory_of_the_program(run, sequence, tmp_path):
    assert run_program("run", sequence, "--set", "frontend.max_features=120", "--out", tmp_path / "o").returncode == 0
    expected = eval.read_trajectory(tmp_path / "o" / "trajectory.tum")
    assert np.array_equal(run.trajectory.positions, expected.positions) and len(expected) > 10
    assert run.result["status"] == "ok" and (run.folder / "manifest.json").exists()


def test_files_are_temporary_without_a_folder(sequence):
    short = stillpoint.run(sequence, options=["--max-frames", 12])
    assert short.folder is None and short.result["frames"] == 12


@pytest.mark.parametrize(
    "arguments, message",
    [
        ({"sequence": "/no/such/folder"}, "is neither a folder nor a preset"),
        ({"overrides": {"frontend.max_feature": 1}}, 'unknown key "frontend.max_feature"; did you mean'),
        ({"overrides": {"frontend.max_features": "many"}}, "frontend.max_features"),
        ({"config": "no_such_config"}, "no_such_config"),
        ({"options": ["--no-such-option"]}, "--no-such-option"),
    ],
)
def test_errors_of_the_program_are_input_errors(sequence, arguments, message):
    with pytest.raises(InputError, match=message):
        stillpoint.run(**{"sequence": sequence, **arguments})


def test_a_missing_program_is_an_input_error(monkeypatch):
    monkeypatch.setenv("PATH", "/no/such/folder")
    monkeypatch.delenv("STILLPOINT_PROGRAM")
    monkeypatch.setattr("stillpoint.runs.__file__", "/no/such/folder/a/b/c/runs.py")
    with pytest.raises(InputError, match="install the package stillpoint"):
        stillpoint.run("walking_xyz")


def example(name, *arguments):
    return subprocess.run([sys.executable, "-B", EXAMPLES / name, *map(str, arguments)], capture_output=True, text=True, check=False,
                          env=os.environ)


def output_of(name, *arguments):
    done = example(name, *arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_example_scores_files(folder):
    lines = output_of("score_files.py", folder / "gt.tum", folder / "a.tum", folder / "b.tum").splitlines()
    gt, est = (eval.read_trajectory(folder / name) for name in ("gt.tum", "a.tum"))
    assert len(lines) == 2 and f"ATE {eval.evaluate('strict:se3', gt, est).ate_m.rmse:.4f} m" in lines[0]


def test_example_plots_a_store(store_file, tmp_path):
    output = output_of("plot_store.py", store_file, tmp_path / "plot.png")
    assert "walk" in output and (tmp_path / "plot.png").read_bytes().startswith(b"\x89PNG")


def test_example_computes_a_metric_of_its_own(store_file):
    assert output_of("custom_metric.py", store_file, "stillpoint", "vo").startswith("vo - stillpoint: ")
    assert "no run of both variants" in example("custom_metric.py", store_file, "stillpoint", "other").stderr


def test_example_runs_on_a_dataset_of_its_own(tmp_path):
    output = output_of("custom_dataset.py", tmp_path / "sequence")
    assert float(output.split("ATE ")[1].split()[0]) < 0.01


@pytest.mark.parametrize("name", sorted(path.name for path in EXAMPLES.glob("*.py")))
def test_examples_are_short_and_describe_their_use(name):
    text = (EXAMPLES / name).read_text()
    assert len(text.splitlines()) <= 90
    assert name in example(name).stderr


@pytest.mark.parametrize("name, arguments", [("score_files.py", ["/no/file", "/no/file"]), ("plot_store.py", ["/no/file", "x.png"]),
                                             ("custom_metric.py", ["/no/file", "a", "b"])])
def test_examples_report_missing_files_in_one_line(name, arguments):
    done = example(name, *arguments)
    assert done.returncode != 0 and len(done.stderr.splitlines()) == 1 and "/no/file" in done.stderr
    assert done.stdout == ""
