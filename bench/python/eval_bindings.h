// SPDX-License-Identifier: BSD-3-Clause
/// The parts of the extension module `stillpoint._eval`.
#pragma once

#include <pybind11/pybind11.h>

namespace stillpoint::python {

/// Trajectories from files and arrays, association and alignment.
void bind_trajectories(pybind11::module_& module);

/// Errors of trajectories: ATE, RPE, segments, coverage, protocols, comparison.
void bind_metrics(pybind11::module_& module);

/// Claimed covariances and states against true poses: NEES, honesty, loops.
void bind_consistency(pybind11::module_& module);

/// Rank tests, intervals, modes and change points of lists of numbers.
void bind_statistics(pybind11::module_& module);

}  // namespace stillpoint::python
