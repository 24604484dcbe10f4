// SPDX-License-Identifier: BSD-3-Clause
/// The result of `stillpoint calibrate` as a table, as JSON, and as a rig file.
#pragma once

#include <string>

#include "core/calibration/calibrate.h"

namespace stillpoint::bench {

/// What was calibrated, for the outputs.
struct CalibrationSubject {
  std::string sequence;
  bool has_imu = false;
  bool has_depth_camera = false;  ///< depth images are those of another camera
  double seconds = 0.0;           ///< duration of the recording
};

/// Table of the parameters, and the residuals.
[[nodiscard]] std::string calibration_table(const CalibrationSubject& subject,
                                            const CalibrationResult& result);

/// The same as JSON, with full precision.
[[nodiscard]] std::string calibration_json(const CalibrationSubject& subject,
                                           const CalibrationResult& result);

/// A rig file (see datasets/calibration/rig_file.h), with deviation and stated value of each estimated number
/// as comments.
[[nodiscard]] std::string calibrated_rig_text(const CalibrationSubject& subject,
                                              const CalibrationResult& result);

}  // namespace stillpoint::bench
