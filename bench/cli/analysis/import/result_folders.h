// SPDX-License-Identifier: BSD-3-Clause
/// Folders of trajectories, as other benchmarks keep them, as runs of a store: each estimate is scored
/// against the ground truth of its sequence like a run of a plan. Written from public descriptions of these
/// tools and tested with made-up files; no file that a tool wrote was available.
///
///   ov_eval    algorithms/SYSTEM/SEQUENCE/RUN.txt; truth/SEQUENCE.txt or truths/SEQUENCE.txt
///   evalio     DATASET/SEQUENCE/PIPELINE.csv or DATASET/SEQUENCE/PIPELINE__PARAMETER-VALUE.csv; gt.csv
///              beside them
///   VSLAM-LAB  EXPERIMENT/DATASET/SEQUENCE/00000_KeyFrameTrajectory.csv, 00001_... of the evaluation folder;
///              DATASET/SEQUENCE/groundtruth.csv of the benchmark folder
///
/// An experiment file of VSLAM-LAB (datasets/io/experiment_file.h) in place of its folder names the system,
/// and the runs that must exist: one without a trajectory is a failed run.
#pragma once

#include <filesystem>
#include <string>

#include "bench/store/maintenance/maintenance.h"

namespace stillpoint::bench {

struct ResultSource {
  std::filesystem::path path;     ///< folder, or experiment file (.yaml, .yml)
  std::filesystem::path results;  ///< evaluation folder of VSLAM-LAB, for an experiment file
  std::filesystem::path truth;    ///< folder of ground truths; empty: that of the layout; not for VSLAM-LAB
  std::string system;             ///< of a folder of VSLAM-LAB; empty: the name of the experiment
  bool fit_scale = false;         ///< of a folder: to the ground truth, for systems without a scale
};

/// Whether a path is a folder or a YAML file.
[[nodiscard]] bool is_result_source(const std::filesystem::path& path);

/// Adds a run for each trajectory. The runs of one system on one sequence are its repetitions, numbered as
/// their files (those of VSLAM-LAB: + 1), or, if these are not numbered, in the order of their names. A
/// sequence of VSLAM-LAB is DATASET/SEQUENCE, as the folder of its ground truth. Poses of estimate and ground
/// truth are taken for those of the same body frame. A file without a pose is a failed run. The scale of
/// monocular experiments is fitted to the ground truth; a folder does not state it: an estimate whose scale
/// is wrong is named in a warning.
/// @throws InputError for a folder of none of these layouts, a malformed file, a missing ground truth or
/// folder of an experiment, an estimate without a pose at the time of its ground truth, an option that has no
/// effect, and as `add_imported`
[[nodiscard]] MergeReport import_results(const ResultSource& source, const std::filesystem::path& store);

}  // namespace stillpoint::bench
