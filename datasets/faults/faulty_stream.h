// SPDX-License-Identifier: BSD-3-Clause
/// A sequence with injected sensor faults: of its images, the arrival of its frames, its detections, its
/// inertial samples and the stated calibration.
#pragma once

#include <memory>
#include <vector>

#include "core/base/timestamp.h"
#include "datasets/faults/sensor_fault.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::datasets {

/// A fault is active during [begin, end).
struct FaultInterval {
  Timestamp begin;
  Timestamp end;
};

/// The intervals of a fault between the first frame and `last`.
[[nodiscard]] std::vector<FaultInterval> fault_intervals(const SensorFault& fault, Timestamp first,
                                                         Timestamp last);

/// The stream as damaged sensors would have recorded it: the faults are applied in their order. Draws of a
/// rig are expanded (`expanded_rigs`). Ground truth and labels stay those of the undisturbed sequence.
/// exposure_blur averages along the displacement of the image center by the mean angular rate during the
/// exposure. The result is a function of stream and faults only.
/// @param stream with at least one frame
/// @throws InputError for faults that concern inertial data if the stream has none
[[nodiscard]] std::unique_ptr<SensorStream> with_faults(std::unique_ptr<SensorStream> stream,
                                                        std::vector<SensorFault> faults);

}  // namespace stillpoint::datasets
