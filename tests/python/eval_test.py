# SPDX-License-Identifier: BSD-3-Clause
"""stillpoint.eval gives the numbers of `stillpoint eval` to the bit."""

import functools
import math

import numpy as np
import pytest
from conftest import program_json, run_program
from stillpoint import InputError
from stillpoint import eval as sp

PROTOCOLS = ["compat:tum", "compat:evo", "compat:rpg", "compat:openloris", "strict:se3", "strict:yaw", "strict:sim3",
             "strict:first_pose", "strict:none"]
OPTIONS = {
    "default": ({}, []),
    "offset": ({"offset_s": 0.01}, ["--offset", "0.01"]),
    "delta": ({"rpe_delta": 0.5}, ["--rpe-delta", "0.5"]),
}


def test_protocols_of_the_tests_are_all():
    assert sorted(sp.protocols()) == sorted(PROTOCOLS)


@functools.lru_cache(maxsize=None)
def evaluations(folder, estimate, options):
    """What the program computes, by protocol."""
    arguments = [argument for protocol in PROTOCOLS for argument in ("--protocol", protocol)]
    result = program_json("eval", folder / "gt.tum", folder / estimate, *arguments, *OPTIONS[options][1], "--json")
    return {evaluation["protocol"]: evaluation for evaluation in result["evaluations"]}


def statistics_of(values):
    return None if values is None else values.to_dict()


@pytest.mark.parametrize("options", OPTIONS)
@pytest.mark.parametrize("estimate", ["a.tum", "b.tum"])
@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_evaluation_is_that_of_the_program(folder, gt, protocol, estimate, options):
    expected = evaluations(folder, estimate, options)[protocol]
    result = sp.evaluate(protocol, gt, sp.read_trajectory(folder / estimate), **OPTIONS[options][0])
    for field in ("ate_m", "ate_deg", "rpe_m", "rpe_deg"):
        assert statistics_of(getattr(result, field)) == expected[field], field
    for field in ("version", "text", "gt_poses", "est_poses", "pairs", "coverage", "correct_rate", "first_pose_s",
                  "rpe_pairs", "rpe_delta", "drift_percent", "jitter_m", "notes"):
        assert getattr(result, field) == expected[field], field
    transform = result.alignment.S_w_v
    assert transform.scale == expected["alignment"]["scale"]
    assert transform.translation.tolist() == expected["alignment"]["translation_m"]
    assert transform.quaternion_xyzw.tolist() == expected["alignment"]["quaternion_xyzw"]
    assert [segment.length_m for segment in result.segments] == [s["length_m"] for s in expected["segments"]]
    for segment, of_program in zip(result.segments, expected["segments"]):
        assert segment.yaw_deg.to_dict() == of_program["yaw_deg"]


def test_arrays_and_files_give_equal_results(folder, gt, est):
    rows = np.loadtxt(folder / "a.tum")
    from_arrays = sp.Trajectory(est.times_ns, rows[:, 1:4], rows[:, 4:8])
    assert sp.evaluate("strict:se3", gt, from_arrays).ate_m.to_dict() == sp.evaluate("strict:se3", gt, est).ate_m.to_dict()


def test_errors_per_pose_are_views_and_have_the_rmse(gt, est):
    result = sp.evaluate("compat:tum", gt, est)
    assert result.errors_m.base is not None and not result.errors_m.flags.writeable
    assert len(result.errors_m) == len(result.error_times_ns) == len(result.errors_deg) == result.pairs
    assert math.isclose(np.sqrt(np.mean(result.errors_m**2)), result.ate_m.rmse, rel_tol=1e-12)


@pytest.mark.parametrize(
    "arguments, options",
    [
        (["--protocol", "strict:se4"], {"protocol": "strict:se4"}),
        (["--protocol", "compat:evo", "--rpe-unit", "f", "--rpe-delta", "0.5"],
         {"protocol": "compat:evo", "rpe_unit": "f", "rpe_delta": 0.5}),
        (["--protocol", "compat:tum", "--offset", "1000"], {"protocol": "compat:tum", "offset_s": 1000.0}),
    ],
)
def test_messages_are_those_of_the_program(folder, gt, est, arguments, options):
    done = run_program("eval", folder / "gt.tum", folder / "a.tum", *arguments)
    assert done.returncode == 2
    with pytest.raises(InputError) as error:
        sp.evaluate(options.pop("protocol"), gt, est, **options)
    assert str(error.value).split(": ", 1)[1] in done.stderr


@pytest.mark.parametrize("name, protocol", [("ate_rmse_m", "compat:tum"), ("rpe_trans_rmse_m_per_s", "compat:tum"),
                                            ("correct_rate", "strict:se3"), ("first_pose_s", "strict:se3")])
def test_score_has_the_metrics_of_its_protocols(folder, gt, est, name, protocol):
    score = sp.score(gt, est)
    values = {"ate_rmse_m": score.ate.translation_m.rmse, "rpe_trans_rmse_m_per_s": score.rpe.translation_m.rmse,
              "correct_rate": score.correct_rate, "first_pose_s": score.first_pose_s}
    assert values[name] == evaluations(folder, "a.tum", "default")[protocol][name]


@pytest.mark.parametrize("unknown", ["ate", "alignmentt"])
def test_unknown_options_are_rejected(gt, est, unknown):
    with pytest.raises(TypeError, match="unknown option"):
        sp.evaluate("strict:se3", gt, est, **{unknown: 1})
    with pytest.raises(InputError, match="expected one of: none, first_pose, yaw, se3, sim3"):
        sp.evaluate("strict:se3", gt, est, alignment="rigid")


def test_covariances_are_scored_as_by_the_program(folder, gt, est):
    rows = np.loadtxt(folder / "a.tum")
    variances = np.random.default_rng(3).uniform(1e-4, 9e-4, (len(rows), 6))
    path = folder / "with_covariance.tum"
    stamps = [line.split()[0] for line in (folder / "a.tum").read_text().splitlines()[1:]]
    path.write_text("".join(f"{t} {' '.join(repr(v) for v in row[1:])} {' '.join(repr(v) for v in variance)}\n"
                            for t, row, variance in zip(stamps, rows.tolist(), variances.tolist())))
    expected = program_json("eval", folder / "gt.tum", path, "--protocol", "strict:se3", "--json")["covariance"]
    table = sp.read_covariances(path, est)
    score = sp.covariance_score(gt, est, table.position, table.rotation)
    for part in ("position", "rotation"):
        quality = getattr(score, part)
        assert quality.nees == expected[part]["nees_ratio"]
        assert [quality.nees_low, quality.nees_high] == expected[part]["nees_ratio_95_percent"]
        assert (quality.nll, quality.within_3_sigma) == (expected[part]["nll"], expected[part]["within_3_sigma"])
    assert table.position.shape == (len(est), 3, 3) and not table.position.flags.owndata


def test_comparison_is_that_of_the_program(folder, gt):
    result = program_json("eval", folder / "gt.tum", folder / "a.tum", folder / "b.tum", "--protocol", "strict:se3", "--json")
    runs = {name: sp.read_trajectory(folder / name) for name in ("a.tum", "b.tum")}
    comparison = sp.compare_runs(gt, runs)
    expected = result["comparison"]
    assert comparison.common_s == expected["common_s"]
    for run, of_program in zip(comparison.ranking, expected["ranking"], strict=True):
        assert run.name == of_program["estimate"]
        assert run.common_ate_rmse_m == of_program["common_ate_rmse_m"]
        assert run.common_pairs == of_program["common_pairs"]


def test_time_offset_is_found(gt, est):
    late = sp.Trajectory(est.times_ns + 10**8, est.positions, est.quaternions_xyzw)
    offset = sp.find_time_offset(gt, late)
    assert not offset.undetermined and abs(offset.offset_s + 0.104) < 0.01


def test_runs_without_a_trajectory_are_errors(gt, est):
    with pytest.raises(InputError, match="runs: lost: is None"):
        sp.compare_runs(gt, {"found": est, "lost": None})


def test_reflections_are_no_transforms(est):
    with pytest.raises(InputError, match="not a rotation"):
        sp.move_to_frame(est, np.diag([1.0, 1.0, -1.0, 1.0]))
