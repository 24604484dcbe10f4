// SPDX-License-Identifier: BSD-3-Clause
/// Optional outputs of a run: dynamic labels of all features, plots of its cost, annotated images, a
/// video, a recording for viewers and a point cloud. None of their failures affects the run or its result.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/run/odometry_run.h"
#include "core/config/frontend_config.h"
#include "core/pipeline/runners/runner.h"
#include "datasets/mapping/voxel_map.h"
#include "datasets/sensor_stream.h"
#include "reports/frames/annotated_frames.h"
#include "reports/frames/landmark_samples.h"
#include "reports/frames/run_recording.h"
#include "reports/frames/surface_samples.h"

namespace stillpoint::bench {

/// Dynamic labels with their reasons: rows of labels.csv, one per feature of each frame that entered the
/// window.
class LabelDump {
 public:
  void add(const FrameReport& report);

  /// CSV with the header `frame,t,id,u_px,v_px,depth_m,age,label,reason,residual_px`; depth 0: not measured,
  /// empty residual: not evaluated.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_ = "frame,t,id,u_px,v_px,depth_m,age,label,reason,residual_px\n";
};

/// The requested outputs.
struct DumpRequest {
  std::filesystem::path folder;  ///< of the run: labels.csv, cost.svg, loop_cost.svg, and those of `images`
  bool labels = false;
  bool cost = false;
  std::filesystem::path video;  ///< folder; empty = none
  std::size_t images = 0;       ///< number of annotated images of the worst frames; with landmarks, surfaces
  std::filesystem::path mcap;   ///< recording for viewers; empty = none
  bool mcap_images = false;     ///< the recording contains color and depth images
  std::filesystem::path map_cloud;  ///< point cloud of static surfaces; empty = none
  double map_voxel_m = 0.02;        ///< side of its voxels
  bool closes_loops = false;        ///< the cloud is that of the optimized trajectory
};

/// Values of --dump. @throws InputError for a name that is not one of them
void require_known_dumps(const std::vector<std::string>& names);

/// The outputs of one run.
class RunDumps {
 public:
  /// Creates the folders and the recording, so that unusable ones are reported before the run.
  /// @param stream must outlive this object; its frames are loaded again for the cloud of an optimized
  /// trajectory
  /// @throws InputError if one of them cannot be created
  RunDumps(DumpRequest request, const datasets::SensorStream& stream, const FrontendConfig& frontend);

  /// Whether `add` has to be called with the frames.
  [[nodiscard]] bool needs_frames() const {
    return request_.labels || video_ || worst_frames_ || recording_ || map_;
  }

  /// Frames in order. An output that cannot be written ends; the others continue.
  void add(const FrameReport& report);

  /// Writes what is written at the end of the run. Call it after the result was written.
  /// @param run for its processing times and loops; null to omit them
  /// @return failures of all outputs, one sentence each
  [[nodiscard]] std::vector<std::string> finish(const OdometryRun* run);

 private:
  /// A frame of the map.
  struct MapFrame {
    std::int64_t index = 0;
    Timestamp t;
    int segment = 0;
    Pose T_w_c;
    SemanticMask mask;
  };

  /// Adds a frame that entered the window and is located in the first world to the map, up to ten per second,
  /// without the pixels in the semantic mask. With loop closure the frame is kept for `fuse_optimized`.
  void add_to_map(const FrameReport& report);
  /// Adds the kept frames at their optimized poses; without loops, because the run was interrupted, those of
  /// the first world at the poses that they had.
  void fuse_optimized(const LoopRun* loops);

  /// Calls `action`. @return whether it succeeded
  template <class Action>
  bool attempt(const char* name, const Action& action);

  DumpRequest request_;
  const datasets::SensorStream& stream_;
  LabelDump labels_;
  std::optional<report::RunVideo> video_;
  std::optional<report::WorstFrames> worst_frames_;
  report::LandmarkSamples landmarks_;
  std::optional<report::SurfaceSamples> surfaces_;
  std::optional<report::RunRecording> recording_;
  std::optional<datasets::VoxelMap> map_;
  std::optional<Timestamp> map_t_;  ///< of the last frame in the map
  std::vector<MapFrame> map_frames_;
  std::vector<std::string> failures_;
};

}  // namespace stillpoint::bench
