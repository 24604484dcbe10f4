// SPDX-License-Identifier: BSD-3-Clause
/// Sequence validator (`stillpoint data check`): summarizes a sequence folder and reports all faults in it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "datasets/open_sequence.h"

namespace stillpoint::datasets {

enum class Severity {
  kWarning,  ///< usable, but with degraded accuracy
  kError,    ///< a run would be rejected, or would skip the frame
};

/// One fault of the sequence.
struct Finding {
  Severity severity = Severity::kError;
  std::string location;  ///< a file (and line), or a stream
  std::string text;      ///< description of the fault
};

/// Timing statistics of one sensor stream.
struct StreamSummary {
  std::string name;  ///< "images", "imu", "ground truth"
  std::size_t count = 0;
  double rate_hz = 0.0;  ///< inverse of the median interval; 0 for fewer than two timestamps
  double first_s = 0.0;  ///< first timestamp, relative to the first image
  double last_s = 0.0;   ///< last timestamp, relative to the first image
  double longest_gap_s = 0.0;
};

struct CheckReport {
  std::string name;
  std::string format;
  std::vector<StreamSummary> streams;
  double depth_offset_s = 0.0;  ///< median of depth timestamp minus color timestamp
  std::vector<std::string> notes;
  std::vector<Finding> findings;

  /// Exit code of the check: 0 if there are no findings, else 1; 2 is for a folder that `check_sequence`
  /// rejects.
  [[nodiscard]] int exit_code() const { return findings.empty() ? 0 : 1; }
};

struct CheckOptions {
  OpenOptions open;
  std::function<void(std::size_t done, std::size_t total)>
      progress;  ///< may be empty; called after each frame
};

/// Reads all files of the folder, decodes every image, and reports all faults at once: faulty rows,
/// timestamps out of order or repeated, gaps, streams that do not overlap the images in time, missing and
/// undecodable images, images without recorded boxes where others have some, depth images without valid
/// pixels, inertial data outside the range of sensors or in
/// other units, and what `gravity_finding`, `gyro_truth_finding` and `ImagePlausibility` find.
/// @throws InputError if the folder cannot be read as a sequence at all
[[nodiscard]] CheckReport check_sequence(const std::filesystem::path& folder,
                                         const CheckOptions& options = {});

/// The report as human-readable text.
[[nodiscard]] std::string report_text(const CheckReport& report);

}  // namespace stillpoint::datasets
