// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/run_recording.h"

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "datasets/foxglove/messages.h"
#include "datasets/foxglove/protobuf.h"
#include "datasets/io/image_io.h"
#include "eval/metrics/rpe.h"
#include "eval/trajectory/alignment.h"
#include "reports/frames/annotated_frames.h"
#include "reports/frames/recording_channels.h"

namespace stillpoint::report {
namespace {

using datasets::FoxgloveHeader;
using datasets::ProtobufWriter;

constexpr const char* kMapFrame = "map";
constexpr const char* kBodyFrame = "body";
constexpr datasets::MessageColor kDetectedBox = {.r = 255, .g = 230, .b = 0};
constexpr datasets::MessageColor kCompensatedBox = {.r = 60, .g = 140, .b = 255};
constexpr double kMillimeters = 1000.0;  ///< per meter

datasets::MessageColor color_of(std::optional<LabelClass> label) {
  const cv::Scalar rgb = label_color(label);
  return {.r = static_cast<std::uint8_t>(rgb[0]),
          .g = static_cast<std::uint8_t>(rgb[1]),
          .b = static_cast<std::uint8_t>(rgb[2])};
}

/// Calls `action` with each feature and its label, if it has one. Both lists are sorted by id.
template <class Action>
void for_each_label(const FrameReport& report, const Action& action) {
  auto label = report.dynamic.labels.begin();
  for (const TrackedFeature& feature : report.tracked.features) {
    while (label != report.dynamic.labels.end() && label->id < feature.id) ++label;
    const bool found = label != report.dynamic.labels.end() && label->id == feature.id;
    action(feature, found ? std::optional(label->label) : std::nullopt);
  }
}

/// The covariance of position and rotation, both in the axes of the world; row-major.
std::vector<double> pose_covariance(const OdometryUpdate& update) {
  Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Identity();
  J.bottomRightCorner<3, 3>() = update.state.T_w_b.R();
  const Eigen::Matrix<double, 6, 6, Eigen::RowMajor> covariance =
      J * update.covariance->pose() * J.transpose();
  return {covariance.data(), covariance.data() + covariance.size()};
}

std::string state_message(const FrameReport& report) {
  const OdometryUpdate& update = report.update;
  ProtobufWriter message;
  message.bytes(1, datasets::encode_timestamp(report.frame.t))
      .bytes(2, world_frame(update.segment))
      .bytes(3, datasets::encode_pose(update.state.T_w_b));
  if (update.inertial) {
    message.bytes(4, datasets::encode_vector(update.state.v_w))
        .bytes(5, datasets::encode_vector(update.state.gyro_bias))
        .bytes(6, datasets::encode_vector(update.state.accel_bias));
  }
  message.number(7, update.time_offset_s).number(8, update.depth_scale);
  if (update.covariance) message.numbers(9, pose_covariance(update));
  return message.take();
}

/// The times of the modules that were executed.
std::string timings_message(const FrameReport& report) {
  std::vector<bench::TimingSample> samples;
  for (std::size_t i = 0; i < kModuleCount; ++i) {
    const auto module = static_cast<Module>(i);
    const ModuleTime& time = report.update.timings[module];
    if (time.calls > 0)
      samples.push_back({report.update.frame_id, std::string(module_name(module)), time.ns, time.calls});
  }
  return encode_timings(report.frame.t, report.update.frame_id, samples);
}

std::string imu_message(const ImuSample& sample) {
  return ProtobufWriter()
      .bytes(1, datasets::encode_timestamp(sample.t))
      .bytes(2, datasets::encode_vector(sample.gyro_b))
      .bytes(3, datasets::encode_vector(sample.accel_b))
      .take();
}

std::string loop_message(const LoopRecord& loop) {
  return ProtobufWriter()
      .bytes(1, datasets::encode_timestamp(loop.query_t))
      .integer(2, loop.query_frame)
      .bytes(3, datasets::encode_timestamp(loop.match_t))
      .integer(4, loop.match_frame)
      .integer(5, loop.votes)
      .integer(6, loop.matches)
      .integer(7, loop.inliers)
      .number(8, loop.residual_px)
      .bytes(9, outcome_name(loop.outcome))
      .integer(10, loop.in_map ? 1 : 0)
      .bytes(11, datasets::encode_pose(loop.T_match_query))
      .take();
}

std::string annotations_message(const FrameReport& report) {
  std::map<std::optional<LabelClass>, datasets::AnnotatedPoints> groups;
  for_each_label(report, [&](const TrackedFeature& feature, std::optional<LabelClass> label) {
    groups[label].pixels.push_back(feature.pixel);
  });
  std::vector<datasets::AnnotatedPoints> annotations;
  for (auto& [label, points] : groups) {
    points.color = color_of(label);
    annotations.push_back(std::move(points));
  }
  for (const TrackedBox& tracked : report.dynamic.boxes) {
    const Box& box = tracked.box;
    annotations.push_back({.pixels = {{box.x_min, box.y_min},
                                      {box.x_max, box.y_min},
                                      {box.x_max, box.y_max},
                                      {box.x_min, box.y_max}},
                           .color = tracked.compensated ? kCompensatedBox : kDetectedBox,
                           .closed_line = true,
                           .text = tracked.class_name + (tracked.compensated ? " (compensated)" : "")});
  }
  return datasets::encode_annotations(report.frame.t, annotations);
}

std::string landmarks_message(const FrameReport& report) {
  std::vector<datasets::ColoredPoint> points;
  for_each_label(report, [&](const TrackedFeature& feature, std::optional<LabelClass> label) {
    if (feature.depth <= 0.0) return;
    const Eigen::Vector3d p_c = feature.depth * feature.bearing.homogeneous();
    points.push_back({.p = p_c.cast<float>(), .color = color_of(label)});
  });
  return datasets::encode_point_cloud({report.frame.t, kCameraFrame}, points);
}

std::string depth_message(const Frame& frame) {
  cv::Mat millimeters;
  frame.depth.convertTo(millimeters, CV_16UC1, kMillimeters / frame.depth_units_per_m);
  return datasets::encode_deep_image({frame.t, kCameraFrame}, millimeters.cols,
                                     {millimeters.ptr<std::uint16_t>(), millimeters.total()});
}

/// 255 where the measured depth belongs to an object, by the boxes.
std::string mask_message(const FrameReport& report) {
  const Frame& frame = report.frame;
  cv::Mat mask = cv::Mat::zeros(frame.depth.size(), CV_8UC1);
  for (const SemanticMask::MaskedBox& masked : report.dynamic.mask.boxes()) {
    const cv::Rect area =
        cv::Rect(cv::Point(static_cast<int>(masked.box.x_min), static_cast<int>(masked.box.y_min)),
                 cv::Point(static_cast<int>(masked.box.x_max) + 1, static_cast<int>(masked.box.y_max) + 1)) &
        cv::Rect({}, mask.size());
    for (int row = area.y; row < area.br().y; ++row) {
      for (int column = area.x; column < area.br().x; ++column) {
        const double depth_m = frame.depth.at<std::uint16_t>(row, column) / frame.depth_units_per_m;
        if (depth_m > 0.0 && report.dynamic.mask.covers({column, row}, depth_m))
          mask.at<std::uint8_t>(row, column) = 255;
      }
    }
  }
  return datasets::encode_mono_image({frame.t, kCameraFrame}, mask.cols,
                                     {mask.ptr<std::uint8_t>(), mask.total()});
}

}  // namespace

struct RunRecording::Impl {
  Impl(const std::filesystem::path& file, const datasets::SequenceInfo& sequence, RecordedImages recorded)
      : info(sequence),
        images(recorded),
        truth(eval::move_to_frame(sequence.ground_truth.trajectory, sequence.ground_truth.T_c_f.inverse(),
                                  "camera")),
        channels(file, sequence.frame_times.front()) {}

  /// IMU samples and true poses up to a frame.
  void write_references(Timestamp t) {
    for (; next_imu < info.imu.size() && info.imu[next_imu].t <= t; ++next_imu) {
      const ImuSample& sample = info.imu[next_imu];
      if (sample.t.ns >= 0) channels.write("/imu", "stillpoint.Imu", sample.t, imu_message(sample));
    }
    for (; next_truth < truth.poses.size() && truth.poses[next_truth].t <= t; ++next_truth) {
      const auto& [T_w_c, stamp] = truth.poses[next_truth];
      if (stamp.ns >= 0) channels.write_pose("/truth", {stamp, kTruthFrame}, T_w_c);
    }
  }

  void write_estimate(const OdometryUpdate& update, Timestamp t) {
    const std::string world = world_frame(update.segment);
    const std::string suffix = update.segment == 0 ? "" : "/segment_" + std::to_string(update.segment);
    channels.write_pose("/estimate" + suffix, {t, world}, update.T_w_c);
    channels.write_transform({t, world}, kBodyFrame, update.state.T_w_b);
    channels.write_transform({t, kBodyFrame}, kCameraFrame, update.state.T_w_b.inverse() * update.T_w_c);
    if (update.segment != 0) return;
    estimate.poses.push_back({t, update.T_w_c});
    if (aligned) return;
    const auto matches = eval::strict_matches(truth, {.frame = "camera", .poses = {{t, update.T_w_c}}});
    if (matches.empty()) return;
    channels.write_transform({t, world}, kTruthFrame, matches.front().est * matches.front().gt.inverse());
    aligned = true;
  }

  /// The pose of a world in the map, when it has changed.
  void write_map(const OdometryUpdate& update, Timestamp t) {
    const auto known = T_m_w.find(update.segment);
    const bool same = known != T_m_w.end() && known->second.p == update.T_m_w.p &&
                      known->second.q.coeffs() == update.T_m_w.q.coeffs();
    if (!update.in_map || same) return;
    T_m_w[update.segment] = update.T_m_w;
    channels.write_transform({t, kMapFrame}, world_frame(update.segment), update.T_m_w);
  }

  void write_images(const FrameReport& report) {
    const Frame& frame = report.frame;
    const cv::Mat color = color_image(frame);
    channels.write("/camera/image", "foxglove.CompressedImage", frame.t,
                   datasets::encode_jpeg_message({frame.t, kCameraFrame},
                                                 datasets::encode_jpeg(color.empty() ? frame.gray : color)));
    if (!frame.depth.empty())
      channels.write("/camera/depth", "foxglove.RawImage", frame.t, depth_message(frame));
    if (!frame.depth.empty() && !report.dynamic.labels.empty())
      channels.write("/camera/mask", "foxglove.RawImage", frame.t, mask_message(report));
  }

  const datasets::SequenceInfo& info;
  RecordedImages images;
  Trajectory truth;  ///< of the camera
  RecordingChannels channels;
  Trajectory estimate;         ///< of segment 0
  std::size_t next_imu = 0;    ///< first sample that is not written yet
  std::size_t next_truth = 0;  ///< first true pose that is not written yet
  bool aligned = false;        ///< the pose of the ground truth in the world was written
  std::map<int, Pose> T_m_w;   ///< as written, by segment
};

RunRecording::RunRecording(const std::filesystem::path& file, const datasets::SequenceInfo& info,
                           RecordedImages images) {
  if (info.frame_times.empty() || info.frame_times.front().ns < 0)
    throw InputError(
        info.folder.string(),
        "has no frames, or frames at negative times, which MCAP files do not have; run it without --mcap");
  impl_ = std::make_shared<Impl>(file, info, images);
  const FoxgloveHeader camera{info.frame_times.front(), kCameraFrame};
  impl_->channels.write("/camera/calibration", "foxglove.CameraCalibration", camera.t,
                        datasets::encode_camera(camera, info.rig.camera));
  impl_->channels.write_path("/truth/path", kTruthFrame, impl_->truth);
}

void RunRecording::add(const FrameReport& report) {
  const Timestamp t = report.frame.t;
  const OdometryUpdate& update = report.update;
  impl_->write_references(t);
  impl_->write_map(report.update, t);
  if (is_located(report.update.status)) {
    impl_->write_estimate(report.update, t);
    impl_->channels.write("/state", "stillpoint.State", t, state_message(report));
  }
  impl_->channels.write("/status", "stillpoint.Status", t,
                        encode_status({.t = t,
                                       .frame = update.frame_id,
                                       .status = status_name(update.status),
                                       .reason = reason_name(update.reason),
                                       .segment = update.segment,
                                       .counters = update.counters}));
  impl_->channels.write("/timings", "stillpoint.Timings", t, timings_message(report));
  impl_->channels.write("/camera/annotations", "foxglove.ImageAnnotations", t, annotations_message(report));
  impl_->channels.write("/landmarks", "foxglove.PointCloud", t, landmarks_message(report));
  if (impl_->images == RecordedImages::kColorAndDepth) impl_->write_images(report);
}

void RunRecording::finish(const bench::LoopRun* loops) {
  impl_->channels.write_path("/estimate/path", world_frame(0), impl_->estimate);
  if (loops != nullptr) {
    impl_->channels.write_path("/estimate/optimized", kMapFrame, loops->optimized);
    for (const LoopRecord& loop : loops->report.loops)
      impl_->channels.write("/loops", "stillpoint.Loop", loop.query_t, loop_message(loop));
  }
  impl_->channels.finish();
}

}  // namespace stillpoint::report
