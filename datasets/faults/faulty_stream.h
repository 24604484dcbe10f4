// SPDX-License-Identifier: BSD-3-Clause
/// A sequence with injected sensor faults.
///
/// Faults of the transport of frames from the camera.
///
/// Faults of detectors.
///
/// Faults of inertial data: functions from samples to samples.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <opencv2/core/types.hpp>

#include "core/types/detection.h"
#include "core/types/frame.h"
#include "core/types/rig.h"
#include "datasets/faults/sensor_fault.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::datasets {

/// Arrivals with a fault of target `kArrival`, which concerns the frames with a timestamp in its active
/// interval:
///
///   frame_late         t <- t + a
///   frame_reordered    with probability a: t <- 1 us after the timestamp of the next frame
///   frame_duplicated   with probability a: also arrives 1 us after the timestamp of the next frame
///
/// a: amount. The last frame of the sequence has no next one and is not changed by the last two.
/// @param arrivals    empty: each frame arrives at its timestamp
/// @param frame_times of the sequence; the first is the start of the schedule
/// @return in order of time
[[nodiscard]] std::vector<FrameArrival> arrivals_with_fault(std::vector<FrameArrival> arrivals,
                                                            const SensorFault& fault,
                                                            std::span<const Timestamp> frame_times);

/// The result of a detector for one frame, with a fault of target `kDetections`: while it is active, the set
/// becomes `kNone` or `kLate`, or gets `amount` additional boxes of class "person" at random places, each a
/// tenth to a half of the image wide and high. The places depend on the fault and the time only.
/// @param start time of the first frame
[[nodiscard]] DetectionSet detections_with_fault(DetectionSet set, const SensorFault& fault, Timestamp start,
                                                 cv::Size image);

/// Samples as the sensor would have delivered them with a fault of target `kImu`. Within the active interval:
///
///   imu_gap, imu_rate    samples are removed
///   gyro_saturated, accel_saturated    w <- clamp(w, -a, a),  f <- clamp(f, -a, a)  per axis
///   gyro_bias, accel_bias              w <- w + a (1, 1, 1),  f <- f + a (1, 1, 1)
///   shock                              f <- f + a u,  u: random unit vector, the same for each interval
///   imu_jitter, time_offset            t <- t + n, n ~ N(0, a^2);  t <- t + a
///
/// clock_jump shifts the stamps of all samples from its start on. a: amount. Samples whose shifted stamps
/// would not increase keep their order and are moved to 1 us after their predecessor.
/// @param samples in increasing order of time
/// @param start time of the first frame
[[nodiscard]] std::vector<ImuSample> samples_with_fault(std::vector<ImuSample> samples,
                                                        const SensorFault& fault, Timestamp start);

/// A fault is active during [begin, end).
struct FaultInterval {
  Timestamp begin;
  Timestamp end;
};

/// The intervals of a fault between the first frame and `last`.
[[nodiscard]] std::vector<FaultInterval> fault_intervals(const SensorFault& fault, Timestamp first,
                                                         Timestamp last);

/// The stream as damaged sensors would have recorded it: the faults are applied in their order. Ground truth
/// and labels stay those of the undisturbed sequence. The result is a function of stream and faults only.
/// @param stream with at least one frame
/// @throws InputError for faults of inertial data if the stream has none
[[nodiscard]] std::unique_ptr<SensorStream> with_faults(std::unique_ptr<SensorStream> stream,
                                                        std::vector<SensorFault> faults);

}  // namespace stillpoint::datasets
