// SPDX-License-Identifier: BSD-3-Clause
/// Experiment files of VSLAM-LAB (https://github.com/VSLAM-LAB/VSLAM-LAB, README):
///
///   EXPERIMENT:
///     Config: FILE             # in the folder of the experiment file: maps datasets to lists of sequences
///     NumRuns: 3               # per sequence
///     Module: SYSTEM
///     Parameters: {mode: mono}
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillpoint::datasets {

struct ExperimentSequence {
  std::string dataset;  ///< label, e.g. "rgbdtum"
  std::string sequence;
};

struct Experiment {
  std::string name;
  std::string system;  ///< `Module`
  std::string mode;    ///< of the parameters, e.g. "mono" or "rgbd-vi"; empty if it is not stated
  int runs = 1;        ///< per sequence
  std::vector<ExperimentSequence> sequences;
};

/// Reads all experiments of a file, with the sequences of their config files.
/// @throws InputError naming file and key if a value is missing or malformed, or if there is no experiment or
/// no sequence
[[nodiscard]] std::vector<Experiment> read_experiments(const std::filesystem::path& file);

}  // namespace stillpoint::datasets
