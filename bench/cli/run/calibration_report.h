// SPDX-License-Identifier: BSD-3-Clause
/// The result of `stillpoint calibrate` as a table, as JSON, as a rig file, and as a figure.
#pragma once

#include <string>

#include "core/calibration/calibrate.h"
#include "core/geometry/camera.h"
#include "datasets/calibration/rig_yaml_text.h"
#include "reports/drawing/drawing.h"

namespace stillpoint::bench {

/// What was calibrated, for the outputs.
struct CalibrationSubject {
  std::string sequence;
  bool has_imu = false;
  bool has_depth_camera = false;  ///< depth images are those of another camera
};

/// Table of the parameters, and the residuals.
[[nodiscard]] std::string calibration_table(const CalibrationSubject& subject,
                                            const CalibrationResult& result);

/// The same as JSON, with full precision.
[[nodiscard]] std::string calibration_json(const CalibrationSubject& subject,
                                           const CalibrationResult& result);

/// The calibration as a file, with what limits it as comments. A rig file (see
/// datasets/calibration/rig_file.h) has deviation and stated value of each estimated number, too.
[[nodiscard]] std::string calibration_file_text(const CalibrationSubject& subject,
                                                const CalibrationResult& result, datasets::RigFormat format);

/// The parameters as a page of a report; what differs from the stated calibration in red, what was not
/// observed in gray.
[[nodiscard]] report::Drawing parameter_figure(const CalibrationSubject& subject,
                                               const CalibrationResult& result);

/// Mean reprojection error in the cells of a grid over the image, as lines: with the stated calibration, and
/// with that of the other half. What poses and points cannot absorb, as distortion, shows as a pattern; noise
/// does not. Both panels have one scale.
[[nodiscard]] report::Drawing residual_figure(const HeldOutResiduals& residuals, const Camera& camera);

}  // namespace stillpoint::bench
