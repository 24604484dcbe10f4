# SPDX-License-Identifier: BSD-3-Clause
"""The package itself: its names, documents, stubs and start."""

import ast
import importlib
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
import stillpoint

MODULES = ["datasets", "eval", "odometry", "store", "synth"]
FOLDER = Path(stillpoint.__file__).parent


def names_of(module):
    return importlib.import_module(f"stillpoint.{module}").__all__


def members(module):
    return [(module, name) for name in names_of(module)]


@pytest.mark.parametrize("module, name", [pair for module in MODULES for pair in members(module)])
def test_public_names_are_documented(module, name):
    value = getattr(importlib.import_module(f"stillpoint.{module}"), name)
    assert value.__doc__ and value.__doc__.strip()
    if not isinstance(value, type) or issubclass(value, Exception):
        return
    for member, content in vars(value).items():
        if isinstance(content, property):
            assert content.__doc__ and content.__doc__.strip(), member


@pytest.mark.parametrize("module", MODULES)
def test_stubs_have_all_names_with_types(module):
    tree = ast.parse((FOLDER / f"_{module}.pyi").read_text())
    stub = {node.name: node for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    extension = importlib.import_module(f"stillpoint._{module}")
    assert set(stub) == {name for name in vars(extension) if not name.startswith("_")}
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and node.name not in ("__init__",) and not node.decorator_list:
            assert node.returns is not None, node.name
    assert "::" not in ast.unparse(tree)  # a type of C++ that has no class


def test_modules_are_loaded_when_they_are_used():
    script = "import sys, stillpoint; assert 'stillpoint._store' not in sys.modules; stillpoint.store; print('stillpoint._store' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout == "True\n"


def test_unknown_modules_are_attribute_errors():
    with pytest.raises(AttributeError):
        stillpoint.no_such_module


def test_the_package_is_marked_as_typed():
    assert (FOLDER / "py.typed").exists() and set(dir(stillpoint)) == set(stillpoint.__all__)


@pytest.mark.parametrize("module", MODULES)
def test_import_takes_little_processor_time(module):
    script = f"import sys, time; t = time.process_time(); import stillpoint.{module}; print(time.process_time() - t, 'numpy' in sys.modules)"
    loads = [subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split() for _ in range(3)]
    assert min(float(seconds) for seconds, _ in loads) < 0.2
    assert loads[0][1] == "False"  # which alone takes most of this time, and is loaded with the first array


def test_memory_is_constant_in_a_loop_over_many_poses():
    script = """
import resource, numpy as np
from stillpoint import eval as sp
n = 20000
q = np.tile([0.0, 0.0, 0.0, 1.0], (n, 1))
def once():
    a = sp.Trajectory(np.arange(n) * 10**7, np.random.rand(n, 3), q)
    m = sp.PoseMatches(a, a, sp.associate_tum(a, a))
    sp.ate_errors(m, sp.align(m).S_w_v); a.positions; m.gt_positions
once(); once()
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
for _ in range(50): once()
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""
    grown_kb = int(subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout)
    assert grown_kb < 4000  # one iteration takes more


def test_wheel_installs_in_a_new_environment_and_runs_an_example():
    root = Path(__file__).resolve().parents[2]
    done = subprocess.run([root / "scripts" / "wheel.sh", FOLDER.parents[1], "--test"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "ATE 0.0000 m" in done.stdout and "is not part of this installation" in done.stdout


def test_full_wheel_feeds_the_odometry():
    root = Path(__file__).resolve().parents[2]
    command = [root / "scripts" / "wheel.sh", FOLDER.parents[1], "--full", "--test"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "features dynamic" in done.stdout
    wheel = next(line.removeprefix("wheel: ") for line in done.stdout.splitlines() if line.startswith("wheel: "))
    with zipfile.ZipFile(wheel if Path(wheel).is_absolute() else root / wheel) as archive:
        metadata = archive.read(next(name for name in archive.namelist() if name.endswith("/METADATA"))).decode()
    assert "License: GPL-2.0-or-later" in metadata and "SuiteSparse" in metadata


@pytest.mark.parametrize("arguments, message", [(["--tests"], "unknown option"), (["/no/such/build"], "has no Python package")])
def test_wheel_script_reports_wrong_arguments(arguments, message):
    script = Path(__file__).resolve().parents[2] / "scripts" / "wheel.sh"
    done = subprocess.run([script, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and message in done.stderr
