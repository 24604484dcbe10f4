// SPDX-License-Identifier: BSD-3-Clause
/// The sequence doctor: what is in a folder, and what is wrong with it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "datasets/sensor_stream.h"

namespace stillpoint {

enum class Severity {
  kWarning,  ///< usable, but results will suffer
  kError,    ///< something that a run refuses or skips
};

/// One thing that is wrong.
struct Finding {
  Severity severity = Severity::kError;
  std::string place;  ///< a file (and line), or a stream
  std::string text;   ///< what was found
};

/// Facts of one stream of stamps.
struct StreamSummary {
  std::string name;  ///< "pictures", "imu", "ground truth", "detections"
  std::size_t count = 0;
  double rate_hz = 0.0;  ///< of the median interval; 0 for less than two stamps
  double first_s = 0.0;  ///< first stamp, since the first picture
  double last_s = 0.0;   ///< last stamp, since the first picture
  double longest_gap_s = 0.0;
};

struct CheckReport {
  std::string name;
  std::string format;
  std::vector<StreamSummary> streams;
  double depth_offset_s = 0.0;  ///< median of depth stamp minus colour stamp
  std::vector<std::string> notes;
  std::vector<Finding> findings;

  /// Exit code of the check: 0 clean, 1 with findings; 2 is for a folder that `check_sequence` refuses.
  [[nodiscard]] int exit_code() const { return findings.empty() ? 0 : 1; }
};

struct CheckOptions {
  OpenOptions open;
  std::function<void(std::size_t done, std::size_t total)> progress;  ///< may be empty; after each picture
};

/// Reads everything in the folder, every picture included, and reports all that is wrong at once: faulty
/// rows, stamps out of order or repeated, gaps, streams that do not overlap the pictures, missing and
/// undecodable pictures, depth pictures without depth, accelerations that are not in m/s^2.
/// @throws InputError if the folder cannot be read as a sequence at all
[[nodiscard]] CheckReport check_sequence(const std::filesystem::path& folder,
                                         const CheckOptions& options = {});

/// The report as lines of text for a person.
[[nodiscard]] std::string report_text(const CheckReport& report);

}  // namespace stillpoint
