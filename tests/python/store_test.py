# SPDX-License-Identifier: BSD-3-Clause
"""stillpoint.store reads what the program stored, with its statistics."""

import io
import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas
import pytest
from conftest import run_program
from stillpoint import InputError, eval, store


@pytest.fixture(scope="module")
def results(store_file):
    return store.Store(store_file)


@pytest.fixture(scope="module")
def tidy(store_file, tmp_path_factory):
    """The table that the program exports: a row per run and metric."""
    path = tmp_path_factory.mktemp("tidy") / "runs.csv"
    assert run_program("store", "export", path, "--tidy", "--store", store_file).returncode == 0
    return pandas.read_csv(path, float_precision="round_trip")


def test_runs_are_those_of_the_plan(results):
    assert sorted((run.variant, run.sequence, run.seed, run.outcome) for run in results.plan_runs("plan")) == [
        ("stillpoint", "walk", 1, "ok"), ("stillpoint", "walk", 2, "ok"), ("vo", "walk", 1, "ok"), ("vo", "walk", 2, "ok")]
    assert 'title = "Python test"' in results.plans()["plan"]


@pytest.mark.parametrize("selection, count", [({}, 4), ({"variant": "vo"}, 2), ({"sequence": "walk"}, 4), ({"system": "x"}, 0),
                                              ({"variant": "vo", "kind": "timing"}, 0)])
def test_runs_are_selected(results, selection, count):
    assert len(results.runs(**selection)) == count


@pytest.mark.parametrize("metric", ["ate_rmse_m", "rpe_trans_rmse_m_per_s", "rpe_rot_rmse_deg_per_s", "correct_rate", "coverage",
                                    "first_pose_s", "frames", "rpe_pairs"])
def test_frame_has_the_values_of_the_exported_table(results, tidy, metric):
    table = results.frame().set_index("key")[metric].dropna()
    exported = tidy[tidy.metric == metric].set_index("run")["value"]
    assert len(table) == len(exported) > 0
    assert table.to_dict() == exported.to_dict()


def test_columns_are_arrays_with_nan_where_a_run_has_no_metric(results):
    columns = results.columns()
    assert all(len(column) == 4 for column in columns.values())
    assert columns["ate_rmse_m"].dtype == np.float64
    sparse = [name for run in results.runs() for name in run.metrics if any(name not in other.metrics for other in results.runs())]
    for name in sparse:
        assert np.array_equal(~np.isnan(columns[name]), [name in run.metrics for run in results.runs()])
    assert sparse  # those of inertial data


def test_columns_of_no_runs_have_the_types_of_those_of_runs(results):
    columns = store.columns([])
    filled = results.columns()
    assert all(len(column) == 0 and column.dtype.kind == filled[name].dtype.kind for name, column in columns.items())


def test_threads_may_share_a_store(results):
    def read(_):
        runs = [run for _ in range(20) for run in results.runs()]
        return len(runs), sum(len(results.trajectory(run)) for run in runs[:4])

    with ThreadPoolExecutor(8) as pool:
        assert len(set(pool.map(read, range(8)))) == 1


def test_trajectories_have_the_stored_error(results):
    for run in results.runs():
        score = eval.score(results.truth(run), results.trajectory(run))
        assert math.isclose(score.ate.translation_m.rmse, run.metrics["ate_rmse_m"], rel_tol=1e-6)  # stored with nine decimals


def test_series_have_one_value_per_frame(results):
    run = results.runs(variant="stillpoint")[0]
    counters = results.frame_counters(run)
    assert counters["frame"].tolist() == list(range(45)) and set(counters["status"]) >= {"tracking"}
    assert counters["tracked_features"].dtype == np.int64 and counters["keyframe"].dtype == bool
    timings = results.timing_samples(run)
    assert {"frame", "module", "ns", "calls"} == set(timings) and (timings["ns"] >= 0).all()
    assert len(timings["ns"]) > 0 and set(timings["module"]) <= {cost.module for cost in run.costs}


def test_attachments_are_read(results):
    run = results.runs()[0]
    assert "trajectory" in results.attachments(run)
    assert results.result(run)["ate_rmse_m"] == run.metrics["ate_rmse_m"]
    assert results.manifest(run)
    assert results.attachment(run, "no such kind") == b""


def groups_of(results):
    groups, left_out = store.select_runs(results, results.runs())
    assert len(groups) == 1 and left_out == []
    return groups[0]


def test_spreads_are_those_of_stats_summary(results, store_file):
    printed = run_program("stats", "summary", "--metric", "ate_rmse_m", "--store", store_file, "--format", "csv").stdout
    rows = pandas.read_csv(io.StringIO(printed), float_precision="round_trip").set_index("variant")
    spreads = store.run_spreads(groups_of(results).runs, "ate_rmse_m")
    assert [spread.variant for spread in spreads] == list(rows.index) == ["stillpoint", "vo"]
    for spread in spreads:
        row = rows.loc[spread.variant]
        assert (spread.runs, spread.failed, spread.spread.count) == (row["runs"], row["failed"], row["n"])
        assert spread.spread.median == row["median"] and spread.spread.worst == row["worst"]


def test_ablation_is_the_difference_of_medians_of_pairs(results):
    rows = store.ablation(groups_of(results).runs, "stillpoint", "ate_rmse_m")
    assert [(row.variant, row.sequence) for row in rows] == [("vo", ""), ("vo", "walk")]
    values = {(run.variant, run.seed): run.metrics["ate_rmse_m"] for run in results.runs()}
    differences = {values["vo", seed] - values["stillpoint", seed] for seed in (1, 2)}
    assert rows[1].difference.count == len(differences)
    assert math.isclose(rows[1].difference.median, np.mean(sorted(differences)), rel_tol=1e-12)


def test_a_base_without_runs_is_an_input_error(results):
    with pytest.raises(InputError, match="stillpoint"):
        store.ablation(results.runs(), "no_such_variant", "ate_rmse_m")


def test_a_store_compared_with_itself_is_the_same(results):
    comparison = store.compare_runs(results.runs(), results.runs())
    assert (comparison.pairs, comparison.bit_equal, comparison.result) == (4, 4, "same")
    assert store.newest_build(results.runs()) == results.runs()[0].build


def test_metrics_are_described():
    metrics = {metric["name"]: metric for metric in store.metric_list()}
    assert metrics["ate_rmse_m"]["unit"] == "m" and metrics["ate_rmse_m"]["direction"] == "smaller is better"


def test_an_extracted_recording_has_the_stored_poses(results, store_file, tmp_path):
    run = results.runs()[0]
    done = run_program("store", "extract", run.key, tmp_path / "run", "--mcap", "--store", store_file)
    assert done.returncode == 0 and "run.mcap" in done.stdout and "not in the store" in done.stdout, done.stderr
    for topic, stored in (("/estimate", results.trajectory(run)), ("/truth", results.truth(run))):
        poses = eval.read_trajectory(f"{tmp_path}/run/run.mcap:{topic}")
        assert len(poses) == len(stored) > 10
        assert np.array_equal(poses.times_ns, stored.times_ns) and np.array_equal(poses.positions, stored.positions)
    again = run_program("store", "extract", run.key, tmp_path / "run", "--mcap", "--store", store_file)
    assert again.returncode == 2 and "run.mcap: exists" in again.stderr


@pytest.mark.parametrize("content", [None, b"", b"no database"])
def test_what_is_no_store_is_an_input_error(tmp_path, content):
    path = tmp_path / "x.sqlite"
    if content is not None:
        path.write_bytes(content)
    done = run_program("store", "list", "--store", path)
    with pytest.raises(InputError) as error:
        store.Store(path)
    assert done.returncode == 2 and str(error.value) in done.stderr
