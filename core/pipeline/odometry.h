// SPDX-License-Identifier: BSD-3-Clause
/// Odometry for a program with its own sensor loop: samples and frames are pushed, poses are returned. Paper
/// Sec. II.
#pragma once

#include <memory>
#include <optional>

#include "core/base/timestamp.h"
#include "core/config/odometry_config.h"
#include "core/types/detection.h"
#include "core/types/frame.h"
#include "core/types/loop_report.h"
#include "core/types/nav_state.h"
#include "core/types/odometry_update.h"
#include "core/types/rig.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

struct DynamicReport;  // core/pipeline/stages/frame_report.h

/// Single-threaded odometry; see threaded_odometry.h for one that does the work on threads of its own. One
/// thread at a time may use an object, including its const functions.
///
///   Odometry odometry(config, rig);
///   loop:
///     odometry.add_imu(sample);                              // as samples arrive
///     once newest sample.t >= odometry.needs_imu_until(frame.t):
///       const OdometryUpdate& update = odometry.track(frame, detections);
///
/// Deterministic: the same samples, frames and detections give bit-identical results, however early the
/// samples are added. `OdometryConfig::detector` is ignored: the caller provides the detections.
class Odometry {
 public:
  /// @throws InputError if the rig lacks a sensor that the configuration requires
  Odometry(const OdometryConfig& config, const Rig& rig);
  ~Odometry();
  Odometry(Odometry&& other) noexcept;
  Odometry& operator=(Odometry&& other) noexcept;

  /// Adds a sample. Samples that are not finite or not later than the previous one are dropped and counted in
  /// `imu_health`.
  void add_imu(const ImuSample& sample);

  /// Time that the IMU samples must have reached before the frame with timestamp `t` is tracked, if it is the
  /// next one: the exposure on the IMU clock (t plus the estimated time offset, first
  /// `Rig::time_offset_s`) plus 20 ms for interpolation. The smallest timestamp if `imu.enabled` is false.
  [[nodiscard]] Timestamp needs_imu_until(Timestamp t) const;

  /// Whether a frame with timestamp `t` would enter the window, if it was the next one. Detections of other
  /// frames are not used, so that the detector can skip them.
  [[nodiscard]] bool enters_window(Timestamp t) const;

  /// Processes the next frame. Never waits. If samples up to the exposure are missing, the newest sample is
  /// held for at most 50 ms (`ImuConfig::max_gap_s`); if more is missing, a frame that enters the window is
  /// located by vision alone (`kDegraded`), or `kLost`. Samples that are added later are used for the
  /// following frames.
  /// @param frame CV_8UC1 gray of the size of the camera; depth of the same size, CV_16UC1, or empty
  /// @param detections of the frame; ignored if it does not enter the window or if `dynamic.mask` is off
  /// @return valid until the next call; the caller may add timings to it
  /// @throws InputError for a frame of another size or type, or one earlier than the previous frame; the
  /// frame is then ignored, but not its IMU samples
  OdometryUpdate& track(const Frame& frame, const DetectionSet& detections = {});

  /// Estimated state at the newest frame that entered the window; nullopt unless it is located or dead
  /// reckoning.
  [[nodiscard]] std::optional<NavState> state() const;

  /// State at time `t` on the clock of the frames (IMU time minus `OdometryUpdate::time_offset_s`): `state`
  /// propagated with the samples received so far, including those later than the newest frame. Beyond the
  /// last sample, that sample is held for at most 50 ms. Without an IMU: constant velocity.
  /// @return nullopt if there is no `state`, if `t` is earlier than it, or if samples up to `t` are missing
  [[nodiscard]] std::optional<NavState> state_at(Timestamp t) const;

  /// Features of the newest frame; valid until the next call of `track`.
  [[nodiscard]] const TrackedFrame& tracked() const;
  /// Dynamic feature recognition in the newest frame; empty if it did not enter the window. Valid until the
  /// next call of `track`.
  [[nodiscard]] const DynamicReport& dynamic() const;

  [[nodiscard]] const ImuHealth& imu_health() const;

  /// Loads the map of an earlier run; once the place of a keyframe is recognized in it, `T_m_w` refers to
  /// that map. Call it before the first frame. @throws InputError unless `loop.enabled`
  void use_map(const KeyframeMap& map);

  /// After the last frame, once: optimizes the pose graph with all keyframes. nullopt unless `loop.enabled`.
  [[nodiscard]] std::optional<LoopReport> finish_loops();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stillpoint
