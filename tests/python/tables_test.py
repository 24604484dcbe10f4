# SPDX-License-Identifier: BSD-3-Clause
"""pandas reads the tables of the program without cleaning, and CSV and JSON have the same values."""

import io
import json
from pathlib import Path

import numpy as np
import pandas
import pytest
from conftest import run_program

SCHEMAS = Path(__file__).resolve().parents[2] / "bench" / "schemas"
STATS = {
    "stats_summary": ["summary"],
    "stats_ablation": ["ablation"],
    "stats_sweep": ["sweep"],
    "stats_repeat": ["repeat"],
    "stats_repeat_with": ["repeat", "--with", "{store}"],
    "stats_faults": ["faults", "--plan", "{plan}"],
    "stats_imperfections": ["imperfections", "--plan", "plan"],
}


def column_types(kind):
    """The JSON types of each column."""
    schema = json.loads((SCHEMAS / f"{kind}.json").read_text())
    columns = schema["properties"]["rows"]["items"]["properties"]
    return {name: set(np.atleast_1d(column.get("type", ["string", "null"]))) for name, column in columns.items()}


def stats(store, kind, form):
    words = [word.format(store=store, plan=store.parent / "faults" / "plan.toml") for word in STATS[kind]]
    done = run_program("stats", *words, "--store", store, "--format", form)
    assert done.returncode in (0, 1), done.stderr
    return done.stdout


def texts(column):
    return [None if pandas.isna(value) else value for value in column]


def expect_equal_tables(kind, document, table):
    """The rows of a JSON document, and the same table from CSV."""
    rows = pandas.DataFrame(document["rows"])
    types = column_types(kind)
    assert document["kind"] == kind and list(table.columns) == list(rows.columns) == list(types)
    assert len(rows) == len(table) > 0
    for name, allowed in types.items():
        if allowed & {"number", "integer"}:
            assert table[name].dtype.kind in "if" or table[name].isna().all(), name
            assert np.array_equal(rows[name].astype(float), table[name].astype(float), equal_nan=True), name
            if allowed == {"integer"}:
                assert rows[name].dtype == table[name].dtype == np.int64, name
        elif allowed == {"boolean"}:
            assert rows[name].dtype == table[name].dtype == bool and (rows[name] == table[name]).all(), name
        else:
            assert texts(rows[name]) == texts(table[name]), name


@pytest.mark.parametrize("kind", STATS)
def test_statistics_are_tables_of_numbers(tables_store, kind):
    document = json.loads(stats(tables_store, kind, "json"))
    table = pandas.read_csv(io.StringIO(stats(tables_store, kind, "csv")), float_precision="round_trip")
    expect_equal_tables(kind, document, table)


LISTS = {
    "plan_list": ["plan", "list"],
    "plan_runs": ["plan", "show", "quick"],
    "systems_list": ["systems", "list"],
    "data_catalogue": ["data", "catalogue"],
    "data_catalogue_sequences": ["data", "catalogue", "tum"],
    "data_faults": ["data", "faults"],
    "config_diff": ["config", "diff", "stillpoint", "dynamic_vins"],
    "config_reference": ["config", "reference"],
    "store_list": ["store", "list", "--store", "{store}"],
}


@pytest.mark.parametrize("kind", LISTS)
def test_lists_are_tables(tables_store, kind):
    done = run_program(*[word.format(store=tables_store) for word in LISTS[kind]], "--json")
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    expect_equal_tables(kind, document, pandas.DataFrame(document["rows"]))


def test_a_run_has_the_rows_of_the_exported_table(tables_store, tmp_path):
    assert run_program("store", "export", tmp_path / "runs.csv", "--tidy", "--store", tables_store).returncode == 0
    exported = pandas.read_csv(tmp_path / "runs.csv", float_precision="round_trip")
    key = exported.run[0]
    document = json.loads(run_program("store", "show", key, "--store", tables_store, "--json").stdout)
    expect_equal_tables("store_runs", document, exported[exported.run == key].reset_index(drop=True))


def test_p_and_n_of_an_ablation_are_numbers(tables_store):
    table = pandas.DataFrame(json.loads(stats(tables_store, "stats_ablation", "json"))["rows"])
    assert table.n.sum() > 0 and table.p.between(0.0, 1.0).any() and table.metric.eq("ate_rmse_m").all()
