// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/view_recovery.h"

#include <algorithm>
#include <utility>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/frontend/outliers/outlier_rejection.h"
#include "core/frontend/point_tracker.h"
#include "core/frontend/track.h"

namespace stillpoint {
namespace {

constexpr std::ptrdiff_t kMinView = 20;  ///< tracks of a view that is worth to be recognized
constexpr int kMinAge = 5;               ///< of these tracks, in images
constexpr int kMaxAttempts = 60;         ///< images with new tracks; then the camera sees another view
constexpr std::size_t kMinFound = 12;    ///< matches, inliers of the motion, and continued tracks
constexpr double kMinInlierRatio = 0.4;
/// Smallest ratio of a lost view's tracks that are found, of those that the motion moves into the image.
/// Right motions find 0.3 and more of them, wrong ones about 0.1 (people who walk ahead of the camera).
constexpr double kMinFoundRatio = 0.2;
constexpr double kMatched_px = 4.0;  ///< largest reprojection error of a match
constexpr double kTracked_px = 3.0;  ///< of a track
constexpr double kConfidence = 0.999;

constexpr int kMaxCorners = 600;
constexpr double kCornerQuality = 0.01;
constexpr double kCornerDistance_px = 10.0;
constexpr float kMaxDistance = 64.0F;  // of 256 bits
constexpr float kMaxRatio = 0.8F;      // Lowe 2004, Sec. 7.1
constexpr float kPatch_px = 31.0F;

/// Upright descriptors are more distinctive, but do not bear a roll of the camera.
enum class Orientation { kUpright, kOfCorners };

struct Described {
  cv::Mat descriptors;
  std::vector<std::size_t> points;  ///< index of each row; points near the border have none
};

/// Direction from a corner to the centroid of the intensities around it (Rosin 1999, Sec. 2) [deg].
float orientation(const cv::Mat& gray, cv::Point2f corner) {
  constexpr int kRadius_px = 15;
  const cv::Point center(corner);
  const cv::Rect image(0, 0, gray.cols, gray.rows);
  double m10 = 0.0, m01 = 0.0;
  for (int dy = -kRadius_px; dy <= kRadius_px; ++dy) {
    for (int dx = -kRadius_px; dx <= kRadius_px; ++dx) {
      const cv::Point pixel = center + cv::Point(dx, dy);
      if (dx * dx + dy * dy > kRadius_px * kRadius_px || !image.contains(pixel)) continue;
      const double intensity = gray.at<std::uint8_t>(pixel);
      m10 += dx * intensity;
      m01 += dy * intensity;
    }
  }
  return cv::fastAtan2(static_cast<float>(m01), static_cast<float>(m10));
}

Described describe(const cv::Mat& gray, const std::vector<cv::Point2f>& pixels, Orientation by) {
  std::vector<cv::KeyPoint> points;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const float angle = by == Orientation::kUpright ? 0.0F : orientation(gray, pixels[i]);
    points.emplace_back(pixels[i], kPatch_px, angle, 0.0F, 0, static_cast<int>(i));
  }
  Described described;
  cv::ORB::create(std::max(1, static_cast<int>(points.size())), 1.2F, 1)
      ->compute(gray, points, described.descriptors);
  for (const cv::KeyPoint& point : points) {
    described.points.push_back(static_cast<std::size_t>(point.class_id));
  }
  return described;
}

/// Pairs of indices of points in both views.
std::vector<std::pair<std::size_t, std::size_t>> match(const Described& from, const Described& to) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  if (from.points.size() < 2 || to.points.size() < 2) return pairs;
  const cv::BFMatcher matcher(cv::NORM_HAMMING);
  std::vector<std::vector<cv::DMatch>> forward;
  std::vector<cv::DMatch> backward;
  matcher.knnMatch(from.descriptors, to.descriptors, forward, 2);
  matcher.match(to.descriptors, from.descriptors, backward);
  for (const std::vector<cv::DMatch>& nearest : forward) {
    const cv::DMatch& best = nearest.front();
    if (best.distance > kMaxDistance || best.distance > kMaxRatio * nearest.back().distance) continue;
    if (backward[static_cast<std::size_t>(best.trainIdx)].trainIdx != best.queryIdx) continue;
    pairs.emplace_back(from.points[static_cast<std::size_t>(best.queryIdx)],
                       to.points[static_cast<std::size_t>(best.trainIdx)]);
  }
  return pairs;
}

std::vector<cv::Point2f> corners_of(const cv::Mat& gray) {
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(gray, corners, kMaxCorners, kCornerQuality, kCornerDistance_px);
  return corners;
}

/// Error of the bearing of a point that is seen from another pose; infinite behind the camera.
double bearing_error(const PointObservation& seen, const Pose& T_to_from) {
  const Eigen::Vector3d p = T_to_from * seen.p_w;
  if (p.z() <= 0.0) return std::numeric_limits<double>::infinity();
  return (p.hnormalized() - seen.bearing).norm();
}

PointObservation correspondence(const Track& track, const Eigen::Vector2d& bearing) {
  return {track.known_depth * track.feature.bearing.homogeneous(), bearing};
}

std::int64_t id_of(const Track& track) { return track.feature.id; }

/// Tracks sorted by id: of those of the lost view, only the found ones continue.
void replace(std::span<const Track> lost, std::span<const Track> found, std::vector<Track>& tracks) {
  std::erase_if(tracks, [&](const Track& track) {
    return std::ranges::binary_search(lost, track.feature.id, {}, id_of);
  });
  tracks.insert(tracks.end(), found.begin(), found.end());
  std::ranges::sort(tracks, {}, id_of);
}

}  // namespace

/// The static tracks of a view, and its corners whose nearest track is one of them.
ViewRecovery::Points ViewRecovery::points_of(const View& view, DynamicIds dynamic_ids) const {
  const auto is_dynamic = [&](const Track& track) {
    return std::ranges::binary_search(dynamic_ids, track.feature.id);
  };
  Points points;
  for (const Track& track : view.tracks) {
    if (is_dynamic(track)) continue;
    points.pixels.push_back(to_point(track.feature.pixel));
    points.depths.push_back(track.known_depth);
  }
  for (const cv::Point2f& corner : corners_of(view.gray)) {
    const Eigen::Vector2d pixel = to_vector(corner);
    const auto nearest = std::ranges::min_element(
        view.tracks, {}, [&](const Track& track) { return (track.feature.pixel - pixel).squaredNorm(); });
    if (nearest != view.tracks.end() && is_dynamic(*nearest)) continue;
    points.pixels.push_back(corner);
    points.depths.push_back(
        sample_depth(view.depth, view.depth_units_per_m, pixel, config_.depth_max_spread));
  }
  return points;
}

/// Motion of the camera T_now_view, if the image shows the points of the view.
std::optional<Pose> ViewRecovery::motion_since(const View& view, DynamicIds dynamic_ids,
                                               const cv::Mat& gray) const {
  const std::vector<cv::Point2f> corners = corners_of(gray);
  if (corners.size() < kMinFound) return std::nullopt;
  const Points points = points_of(view, dynamic_ids);
  for (const Orientation by : {Orientation::kUpright, Orientation::kOfCorners}) {
    std::vector<PointObservation> matches;
    for (const auto& [before, now] :
         match(describe(view.gray, points.pixels, by), describe(gray, corners, by))) {
      const double depth = points.depths[before];
      if (depth <= 0.0) continue;
      matches.push_back({depth * camera_.unproject(to_vector(points.pixels[before])).homogeneous(),
                         camera_.unproject(to_vector(corners[now]))});
    }
    if (const std::optional<Pose> T_now_view = common_motion(matches)) return T_now_view;
  }
  return std::nullopt;
}

std::optional<Pose> ViewRecovery::common_motion(std::span<const PointObservation> matches) const {
  if (matches.size() < kMinFound) return std::nullopt;
  const double threshold = kMatched_px / camera_.focal_px();
  const std::optional<Pose> T_now_view =
      estimate_rigid_motion(matches, {.threshold = threshold, .confidence = kConfidence, .is_large = true});
  if (!T_now_view) return std::nullopt;
  const auto inliers = std::ranges::count_if(
      matches, [&](const PointObservation& seen) { return bearing_error(seen, *T_now_view) <= threshold; });
  const double required =
      std::max(static_cast<double>(kMinFound), kMinInlierRatio * static_cast<double>(matches.size()));
  return static_cast<double>(inliers) >= required ? T_now_view : std::nullopt;
}

std::optional<Pose> ViewRecovery::motion_since_last(const cv::Mat& gray, DynamicIds dynamic_ids) const {
  return motion_since(last_, dynamic_ids, gray);
}

bool ViewRecovery::fits(const Track& before, const Pose& T_now_lost, const Eigen::Vector2d& bearing) const {
  return before.known_depth > 0.0 &&
         bearing_error(correspondence(before, bearing), T_now_lost) <= kTracked_px / camera_.focal_px();
}

std::vector<Track> ViewRecovery::continue_tracks(const View& lost, const Pose& T_now_lost,
                                                 const ImagePyramid& pyramid) const {
  const MotionPrior motion{T_now_lost, true, true};
  const std::vector<cv::Point2f> predicted =
      predict_pixels(lost.tracks, {motion, TrackerPrediction::kFull}, camera_);
  const KltResult forward = track_large_motion(config_, camera_,
                                               {.gray = lost.gray,
                                                .tracks = lost.tracks,
                                                .T_now_before = T_now_lost,
                                                .now = pyramid,
                                                .predicted = predicted});
  std::vector<Track> continued;
  int visible = 0;
  for (std::size_t i = 0; i < lost.tracks.size(); ++i) {
    const Eigen::Vector2d pixel = to_vector(forward.pixels[i]);
    const bool is_visible = camera_.contains(to_vector(predicted[i]), kImageBorder_px);
    visible += is_visible && lost.tracks[i].known_depth > 0.0 ? 1 : 0;
    if (forward.found[i] == 0 || !pixel.allFinite() || !camera_.contains(pixel, kImageBorder_px)) continue;
    const Eigen::Vector2d bearing = camera_.unproject(pixel);
    if (!fits(lost.tracks[i], T_now_lost, bearing)) continue;
    Track track = lost.tracks[i];
    track.feature.pixel = pixel;
    track.feature.bearing = track.reference_bearing = bearing;
    track.feature.velocity.setZero();
    track.feature.depth = track.reference_depth = 0.0;
    ++track.feature.age;
    track.first_view.patch.clear();  // its rotation is not known
    continued.push_back(track);
  }
  if (static_cast<double>(continued.size()) < std::max<double>(kMinFound, kMinFoundRatio * visible))
    continued.clear();
  return continued;
}

/// Less than half of an established view continues.
bool ViewRecovery::loses_view(std::size_t continued) const {
  const auto established =
      std::ranges::count_if(last_.tracks, [](const Track& track) { return track.feature.age >= kMinAge; });
  return established >= kMinView && 2 * continued < last_.tracks.size();
}

void ViewRecovery::lose_last(DynamicIds dynamic_ids) {
  lost_ = std::move(last_);
  lost_dynamic_ids_.assign(dynamic_ids.begin(), dynamic_ids.end());
  attempts_ = 0;
}

void ViewRecovery::break_down(DynamicIds dynamic_ids) {
  if (!lost_ && std::ssize(last_.tracks) >= kMinView) lose_last(dynamic_ids);
}

void ViewRecovery::process(const cv::Mat& gray, const ImagePyramid& pyramid, DynamicIds dynamic_ids,
                           std::vector<Track>& tracks) {
  if (loses_view(tracks.size())) lose_last(dynamic_ids);
  if (!lost_) return;
  attempts_ += tracks.size() >= kMinFound ? 1 : 0;
  if (const std::optional<Pose> T_now_lost = motion_since(*lost_, lost_dynamic_ids_, gray)) {
    const std::vector<Track> found = continue_tracks(*lost_, *T_now_lost, pyramid);
    if (!found.empty()) {
      replace(lost_->tracks, found, tracks);
      lost_.reset();
      return;
    }
  }
  if (attempts_ >= kMaxAttempts) lost_.reset();
}

void ViewRecovery::remember(const Frame& frame, std::span<const Track> tracks) {
  last_.gray = frame.gray;
  last_.depth = frame.depth;
  last_.depth_units_per_m = frame.depth_units_per_m;
  last_.tracks.assign(tracks.begin(), tracks.end());
}

void ViewRecovery::reset() {
  last_.tracks.clear();
  lost_.reset();
}

}  // namespace stillpoint
