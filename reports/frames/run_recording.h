// SPDX-License-Identifier: BSD-3-Clause
/// Records a run as an MCAP file for Foxglove, rerun and other viewers, while it is executed. The messages
/// are Protocol Buffers with the schemas in datasets/foxglove/message_types.h.
///
/// | topic | type | content |
/// |---|---|---|
/// | /estimate | foxglove.PoseInFrame | pose of the camera at each located frame, as in trajectory.tum |
/// | /estimate/segment_N | same | of the world frames after a loss without relocation |
/// | /estimate/path | foxglove.PosesInFrame | all poses of /estimate, written at the end |
/// | /estimate/optimized | same | with all corrections by loop closure, written at the end |
/// | /truth, /truth/path | foxglove.PoseInFrame, PosesInFrame | ground truth of the camera |
/// | /tf | foxglove.FrameTransform | map to world, world to body, body to camera; world to truth |
/// | /status | stillpoint.Status | of each frame, with the reason and counters |
/// | /state | stillpoint.State | pose with covariance, velocity, biases, calibration |
/// | /timings | stillpoint.Timings | of each frame |
/// | /imu | stillpoint.Imu | all samples up to the last frame |
/// | /camera/calibration | foxglove.CameraCalibration | as stated by the sequence |
/// | /camera/annotations | foxglove.ImageAnnotations | features, colored by label, and boxes |
/// | /camera/image | foxglove.CompressedImage | optional: JPEG |
/// | /camera/depth | foxglove.RawImage | optional: 16 bits, in millimeters |
/// | /camera/mask | foxglove.RawImage | optional: 255 where depth and boxes show an object |
/// | /landmarks | foxglove.PointCloud | features with measured depth, in the frame of the camera |
/// | /loops | stillpoint.Loop | recognized places with their outcome, written at the end |
///
/// Coordinate frames: `world`, after a loss `world_N`; `body` (IMU), `camera`; `truth`, which the pose at the
/// first located frame aligns with `world`. The log time of a message is the stamp of its sensor data, of a
/// path that of the first frame, so that viewers show it at any time.
#pragma once

#include <filesystem>
#include <memory>

#include "bench/run/run_scores.h"
#include "core/pipeline/runners/runner.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::report {

/// Whether a recording contains the images of the camera.
enum class RecordedImages { kNone, kColorAndDepth };

/// A recording of one run.
class RunRecording {
 public:
  /// Creates FILE.part, which gets its name by `finish`.
  /// @param info must outlive this object
  /// @throws InputError if the file cannot be created, or the first frame has a negative time, which MCAP
  /// files do not have
  RunRecording(const std::filesystem::path& file, const datasets::SequenceInfo& info, RecordedImages images);

  /// Frames in order.
  void add(const FrameReport& report);

  /// Writes the paths, the loops and the index. The file is complete then.
  /// @param loops null without loop closure
  /// @throws InputError if the file could not be written, e.g. because the disk is full
  void finish(const bench::LoopRun* loops);

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;  ///< shared by copies; builds without MCAP files do not define it
};

}  // namespace stillpoint::report
