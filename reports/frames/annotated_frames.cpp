// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/annotated_frames.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "core/base/error.h"
#include "datasets/io/image_io.h"
#include "datasets/io/shared_module.h"
#include "eval/metrics/rpe.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint::report {
namespace {

namespace fs = std::filesystem;

// R, G, B
const cv::Scalar kStable(60, 220, 60);
const cv::Scalar kObject(255, 50, 40);
const cv::Scalar kMotion(255, 60, 255);
const cv::Scalar kUnlabeled(255, 255, 255);
const cv::Scalar kStableCircle(255, 165, 0);
const cv::Scalar kUnstableCircle(150, 70, 220);
const cv::Scalar kDetected(255, 230, 0);
const cv::Scalar kCompensated(60, 140, 255);
const cv::Scalar kText(255, 255, 255);
const cv::Scalar kShadow(0, 0, 0);

constexpr int kTextFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.5;
constexpr int kCorrectionFrames = 30;
constexpr int kFractionBits = 4;  // OpenCV takes coordinates in 1/16 px

cv::Point fixed(const cv::Point2d& pixel) {
  return {cvRound(pixel.x * (1 << kFractionBits)), cvRound(pixel.y * (1 << kFractionBits))};
}

cv::Mat canvas_of(const Frame& frame) {
  const cv::Mat color = color_image(frame);
  if (!color.empty()) return color.clone();
  cv::Mat canvas;
  cv::cvtColor(frame.gray, canvas, cv::COLOR_GRAY2RGB);
  return canvas;
}

/// Tints pixels that Eq. (1) assigns to a dynamic object.
void draw_mask(const Frame& frame, const SemanticMask& mask, cv::Mat& canvas) {
  if (mask.boxes().empty() || frame.depth.size() != canvas.size()) return;
  for (int row = 0; row < canvas.rows; ++row) {
    for (int column = 0; column < canvas.cols; ++column) {
      const double depth = frame.depth.at<std::uint16_t>(row, column) / frame.depth_units_per_m;
      if (depth <= 0.0 || depth >= mask.threshold_at({column, row})) continue;
      cv::Vec3b& pixel = canvas.at<cv::Vec3b>(row, column);
      pixel[0] = static_cast<std::uint8_t>((pixel[0] + 255) / 2);
      pixel[1] = static_cast<std::uint8_t>(pixel[1] / 2);
      pixel[2] = static_cast<std::uint8_t>(pixel[2] / 2);
    }
  }
}

void write_line(const std::string& text, const cv::Point& at, cv::Mat& canvas) {
  cv::putText(canvas, text, at + cv::Point(1, 1), kTextFont, kFontScale, kShadow, 2, cv::LINE_AA);
  cv::putText(canvas, text, at, kTextFont, kFontScale, kText, 1, cv::LINE_AA);
}

void draw_boxes(const std::vector<TrackedBox>& boxes, cv::Mat& canvas) {
  for (const TrackedBox& tracked : boxes) {
    const cv::Point2d low(tracked.box.x_min, tracked.box.y_min);
    const cv::Point2d high(tracked.box.x_max, tracked.box.y_max);
    const cv::Scalar& color = tracked.compensated ? kCompensated : kDetected;
    cv::rectangle(canvas, fixed(low), fixed(high), color, 2, cv::LINE_AA, kFractionBits);
    const std::string label = tracked.class_name + (tracked.compensated ? " (compensated)" : "");
    write_line(label, cv::Point(std::max(cvRound(low.x), 0) + 4, std::max(cvRound(low.y), 0) + 16), canvas);
  }
}

void write_status(const OdometryUpdate& update, cv::Mat& canvas) {
  const std::string text = std::to_string(update.frame_id) + "  " + std::string(status_name(update.status)) +
                           "  " + std::to_string(update.counters.tracked_features) + " features, " +
                           std::to_string(update.counters.dynamic_features) + " dynamic";
  write_line(text, cv::Point(6, canvas.rows - 8), canvas);
}

/// Change of the correction by loop closure, at the position of the camera.
std::string correction_text(const Pose& before, const OdometryUpdate& update) {
  const Eigen::Vector3d moved = update.T_m_w * update.T_w_c.p - before * update.T_w_c.p;
  const double angle_rad = before.q.angularDistance(update.T_m_w.q);
  return fmt::format("loop closure: corrected by {:.1f} cm, {:.2f} deg", 100.0 * moved.norm(),
                     angle_rad * 180.0 / std::numbers::pi);
}

bool is_same(const Pose& a, const Pose& b) { return a.p == b.p && a.q.coeffs() == b.q.coeffs(); }

}  // namespace

cv::Scalar label_color(std::optional<LabelClass> label) {
  if (!label) return kUnlabeled;
  switch (*label) {
    case LabelClass::kDynamicObject:
      return kObject;
    case LabelClass::kDynamicMotion:
      return kMotion;
    default:
      return kStable;
  }
}

AnnotationStyle annotation_style(const FrontendConfig& frontend) {
  return {.stable_radius_px = frontend.circular_mask ? frontend.min_distance_px : 0,
          .unstable_radius_px = frontend.circular_mask ? frontend.unstable_radius_px : 0};
}

FrameAnnotator::Tracks FrameAnnotator::extended_tracks(const FrameReport& report) const {
  Tracks now;
  for (const TrackedFeature& feature : report.tracked.features) {
    const auto before = tracks_.find(feature.id);
    Track track = before == tracks_.end() ? Track{} : before->second;
    track.pixels.emplace_back(feature.pixel.x(), feature.pixel.y());
    if (track.pixels.size() > style_.track_length) track.pixels.erase(track.pixels.begin());
    now.emplace(feature.id, std::move(track));
  }
  for (const DynamicLabel& label : report.dynamic.labels) {
    const auto track = now.find(label.id);
    if (track == now.end()) continue;
    track->second.has_label = true;
    track->second.label = label.label;
  }
  return now;
}

void FrameAnnotator::draw_circles(const Tracks& now, cv::Mat& canvas) const {
  const auto draw = [&canvas](const cv::Point2d& at, int radius_px, const cv::Scalar& color) {
    if (radius_px > 0)
      cv::circle(canvas, fixed(at), radius_px << kFractionBits, color, 1, cv::LINE_AA, kFractionBits);
  };
  for (const auto& [id, track] : now) draw(track.pixels.back(), style_.stable_radius_px, kStableCircle);
  for (const auto& [id, track] : tracks_) {
    if (!now.contains(id)) draw(track.pixels.back(), style_.unstable_radius_px, kUnstableCircle);
  }
}

/// A world that is located in the map, or a new world, is not a correction.
void FrameAnnotator::note_correction(const OdometryUpdate& update) {
  if (in_map_ && update.in_map && !is_same(update.T_m_w, T_m_w_)) {
    correction_ = correction_text(T_m_w_, update);
    correction_frames_ = kCorrectionFrames;
  }
  T_m_w_ = update.T_m_w;
  in_map_ = update.in_map;
}

cv::Mat FrameAnnotator::annotate(const FrameReport& report) {
  cv::Mat canvas = canvas_of(report.frame);
  Tracks now = extended_tracks(report);
  draw_mask(report.frame, report.dynamic.mask, canvas);
  draw_circles(now, canvas);
  draw_boxes(report.dynamic.boxes, canvas);
  for (const auto& [id, track] : now) {
    const cv::Scalar color = label_color(track.has_label ? std::optional(track.label) : std::nullopt);
    std::vector<cv::Point> points;
    for (const cv::Point2d& pixel : track.pixels) points.push_back(fixed(pixel));
    cv::polylines(canvas, points, false, color, 1, cv::LINE_AA, kFractionBits);
    cv::circle(canvas, points.back(), 3 << kFractionBits, color, cv::FILLED, cv::LINE_AA, kFractionBits);
  }
  write_status(report.update, canvas);
  note_correction(report.update);
  if (correction_frames_-- > 0) write_line(correction_, cv::Point(6, canvas.rows - 26), canvas);
  tracks_ = std::move(now);
  return canvas;
}

namespace {

constexpr double kDefaultRate_hz = 30.0;

VideoSink open(const fs::path& file, cv::Size size, double rate_hz) {
  const auto* const module =
      static_cast<const VideoModule*>(datasets::module_symbol("video", "stillpoint_video_module"));
  return module->open(file, size, rate_hz);
}

bool is_written(const fs::path& file) {
  std::error_code problem;
  const std::uintmax_t bytes = fs::file_size(file, problem);
  return !problem && bytes > 0;
}

}  // namespace

VideoFile::VideoFile(fs::path file, cv::Size size, double rate_hz)
    : file_(std::move(file)), size_(size.width / 2 * 2, size.height / 2 * 2) {
  STILLPOINT_CHECK(!size_.empty() && rate_hz > 0.0);
  encoder_ = open(file_, size_, rate_hz);
  if (!encoder_) {
    throw InputError(
        file_.string(),
        "cannot be written as video; check that the folder is writable and OpenCV is built with FFmpeg");
  }
}

void VideoFile::add(const cv::Mat& image) {
  STILLPOINT_CHECK(image.type() == CV_8UC3 && image.cols / 2 * 2 == size_.width &&
                   image.rows / 2 * 2 == size_.height);
  cv::Mat bgr;
  cv::cvtColor(image(cv::Rect(cv::Point(0, 0), size_)), bgr, cv::COLOR_RGB2BGR);
  encoder_(bgr);
}

void VideoFile::finish() {
  encoder_ = {};
  if (!is_written(file_)) throw InputError(file_.string(), "is incomplete; is the disk full?");
}

RunVideo::RunVideo(fs::path folder, AnnotationStyle style, double rate_hz)
    : folder_(std::move(folder)), annotator_(style), rate_hz_(rate_hz) {
  std::error_code problem;
  fs::create_directories(folder_ / "frames", problem);
  if (problem) {
    throw InputError(folder_.string(),
                     "cannot be created (" + problem.message() + "); choose another --video folder");
  }
}

void RunVideo::add(const FrameReport& report) {
  const cv::Mat image = annotator_.annotate(report);
  datasets::write_jpeg(folder_ / "frames" / fmt::format("{:06}.jpg", report.frame.id), image);
  if (!video_) video_.emplace(folder_ / "video.mp4", image.size(), rate_hz_);
  video_->add(image);
}

void RunVideo::finish() {
  if (video_) video_->finish();
}

double mean_rate_hz(const std::vector<Timestamp>& times) {
  if (times.size() < 2) return kDefaultRate_hz;
  return static_cast<double>(times.size() - 1) / seconds_between(times.front(), times.back());
}

void remove_images(const fs::path& folder) {
  if (!fs::is_directory(folder)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".jpg") fs::remove(entry.path());
  }
  if (fs::is_empty(folder)) fs::remove(folder);
}

namespace {

constexpr int kMaxWidth_px = 400;
constexpr int kJpegQuality = 70;  // text and thin circles stay legible

void create_folder(const fs::path& folder) {
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem) throw InputError(folder.string(), "cannot be created (" + problem.message() + ")");
}

std::vector<std::optional<Pose>> ground_truth_of(const datasets::SequenceInfo& info) {
  const Trajectory truth =
      eval::move_to_frame(info.ground_truth.trajectory, info.ground_truth.T_c_f.inverse(), "camera");
  Trajectory frames;
  for (const Timestamp t : info.frame_times) frames.poses.push_back({t, {}});
  std::vector<std::optional<Pose>> poses(info.frame_times.size());
  std::size_t frame = 0;
  for (const eval::MatchedPose& match : eval::strict_matches(truth, frames)) {
    while (info.frame_times[frame] < match.t) ++frame;
    poses[frame] = match.gt;
  }
  return poses;
}

cv::Mat downscaled(const cv::Mat& image) {
  if (image.cols <= kMaxWidth_px) return image;
  cv::Mat result;
  cv::resize(image, result, {kMaxWidth_px, image.rows * kMaxWidth_px / image.cols}, 0.0, 0.0, cv::INTER_AREA);
  return result;
}

}  // namespace

WorstFrames::WorstFrames(fs::path folder, std::size_t capacity, AnnotationStyle style,
                         const datasets::SequenceInfo& info)
    : folder_(std::move(folder)),
      collected_(fs::path(folder_).concat(".new")),
      annotator_(style),
      worst_(capacity),
      truth_(ground_truth_of(info)) {
  create_folder(folder_);
  remove_images(collected_);  // of a run that was killed
  create_folder(collected_);
}

WorstFrames::~WorstFrames() {
  try {
    remove_images(collected_);
  } catch (const fs::filesystem_error&) {  // no destructor may throw: the next run removes them
  }
}

void WorstFrames::finish() {
  remove_images(folder_);
  fs::create_directories(folder_);
  for (const fs::directory_entry& entry : fs::directory_iterator(collected_)) {
    if (entry.path().extension() == ".jpg") fs::rename(entry.path(), folder_ / entry.path().filename());
  }
}

void WorstFrames::add(const FrameReport& report) {
  const auto frame = static_cast<std::size_t>(report.update.frame_id);
  const eval::WorstFrames::Insertion insertion =
      worst_.insert(frame, frame_to_frame_.next(matched(report.update)));
  if (!insertion.inserted) return annotator_.update_tracks(report);
  datasets::write_jpeg(file_of(frame), downscaled(annotator_.annotate(report)), kJpegQuality);
  if (insertion.evicted) fs::remove(file_of(*insertion.evicted));
}

std::optional<eval::MatchedPose> WorstFrames::matched(const OdometryUpdate& update) const {
  const std::optional<Pose>& truth = truth_.at(static_cast<std::size_t>(update.frame_id));
  if (!truth || !is_located(update.status)) return std::nullopt;
  return eval::MatchedPose{.t = {}, .gt = *truth, .est = update.T_w_c};
}

fs::path WorstFrames::file_of(std::size_t frame) const {
  return collected_ / fmt::format("{:06}.jpg", frame);
}

}  // namespace stillpoint::report
