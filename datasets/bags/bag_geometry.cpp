// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/bag_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "datasets/io/lens_model.h"
#include "eval/io/nmea_file.h"

namespace stillpoint::datasets {
namespace {

constexpr std::string_view kTransforms = "/tf";
constexpr std::string_view kStaticTransforms = "/tf_static";
constexpr std::string_view kTransformsOfFrames = "/tf:";
constexpr std::string_view kNavSatFix = "sensor_msgs/NavSatFix";
constexpr double kMaxInterpolation_s = 1.0;  ///< between two transforms; robots publish at 10 Hz or more

using Link = std::pair<std::string, std::string>;  // parent, child

bool is_transforms_type(std::string_view type) {
  return type == "tf2_msgs/TFMessage" || type == "tf/tfMessage";
}

/// Topics of old recorders and of some MCAP writers have no leading slash.
std::string_view without_slash(std::string_view topic) {
  return topic.starts_with('/') ? topic.substr(1) : topic;
}

/// Calls `action(connection, message, time of recording)` for all messages of a topic, in the order of their
/// bytes.
template <class Action>
void for_each_message(const BagFile& bag, std::string_view topic, const Action& action) {
  std::vector<MessageReference> selected;
  std::ranges::copy_if(bag.messages(), std::back_inserter(selected), [&](const MessageReference& reference) {
    return without_slash(bag.connection(reference).topic) == without_slash(topic);
  });
  for (const MessageReference& reference : in_file_order(selected)) {
    const std::string bytes = bag.payload(reference);
    const std::string place = bag.place(reference);
    const BagConnection& connection = bag.connection(reference);
    action(connection, SerializedMessage{.bytes = bytes, .format = connection.format, .place = place},
           reference.message.t);
  }
}

Timestamp stamp_or(Timestamp stamp, Timestamp recorded) { return stamp.ns == 0 ? recorded : stamp; }

/// Sorts poses by time and drops repeated ones.
eval::LoadedTrajectory sorted_trajectory(std::vector<StampedPose> poses, eval::RowRepairs repairs) {
  for (std::size_t i = 1; i < poses.size(); ++i) repairs.reordered += poses[i].t < poses[i - 1].t;
  std::ranges::stable_sort(poses, {}, &StampedPose::t);
  const auto repeated =
      std::unique(poses.begin(), poses.end(), [](const auto& a, const auto& b) { return a.t == b.t; });
  repairs.repeated += static_cast<std::size_t>(poses.end() - repeated);
  poses.erase(repeated, poses.end());
  return {.trajectory = {.frame = {}, .poses = std::move(poses)}, .repairs = repairs};
}

bool has_position(const NavSatFixMessage& fix) {
  return fix.status >= 0 && std::isfinite(fix.latitude_deg) && std::isfinite(fix.longitude_deg);
}

/// Positions in the tangent plane at the first fix; messages without a fix are skipped, and where others have
/// an altitude those without one.
class GnssPositions {
 public:
  GnssPositions(const BagFile& bag, const std::string& topic) {
    const auto has_fixes = [](const BagConnection& connection) { return connection.type == kNavSatFix; };
    if (std::ranges::none_of(bag.connections(), has_fixes)) return;
    for_each_message(bag, topic,
                     [this](const BagConnection& connection, const SerializedMessage& message, Timestamp) {
                       if (connection.type != kNavSatFix || has_altitudes_) return;
                       const NavSatFixMessage fix = parse_nav_sat_fix(message);
                       has_altitudes_ = has_position(fix) && std::isfinite(fix.altitude_m);
                     });
  }

  std::optional<Pose> pose_of(const NavSatFixMessage& fix) {
    if (!has_position(fix) || (has_altitudes_ && !std::isfinite(fix.altitude_m))) return {};
    const eval::GeodeticPosition position{.latitude_deg = fix.latitude_deg,
                                          .longitude_deg = fix.longitude_deg,
                                          .height_m = has_altitudes_ ? fix.altitude_m : 0.0};
    if (!origin_) origin_ = position;
    return Pose{Eigen::Quaterniond::Identity(), eval::east_north_up(position, *origin_)};
  }

 private:
  bool has_altitudes_ = false;
  std::optional<eval::GeodeticPosition> origin_;
};

eval::LoadedTrajectory trajectory_of_topic(const BagFile& bag, const std::string& topic) {
  std::vector<StampedPose> poses;
  eval::RowRepairs repairs;
  std::string frame;
  GnssPositions positions(bag, topic);
  for_each_message(
      bag, topic, [&](const BagConnection& connection, const SerializedMessage& message, Timestamp recorded) {
        if (!is_trajectory_type(connection.type))
          throw InputError(bag.path().string() + ":" + topic,
                           "has the type " + connection.type +
                               ", which contains no pose; expected PoseStamped, Odometry, TransformStamped, "
                               "PoseInFrame or NavSatFix, or /tf:PARENT.CHILD");
        PoseMessage pose;
        if (connection.type == kNavSatFix) {
          const NavSatFixMessage fix = parse_nav_sat_fix(message);
          pose = {.header = fix.header, .child = eval::kGnssFrame, .pose = positions.pose_of(fix)};
        } else {
          pose = parse_pose(message, connection.type);
        }
        frame = pose.child;
        if (pose.pose) {
          repairs.unstamped += pose.header.stamp.ns == 0 ? 1 : 0;
          poses.push_back({stamp_or(pose.header.stamp, recorded), *pose.pose});
        } else {
          ++repairs.skipped;
          if (connection.type == kNavSatFix) repairs.skip_reason = "no GNSS fix";
        }
      });
  eval::LoadedTrajectory loaded = sorted_trajectory(std::move(poses), repairs);
  loaded.trajectory.frame = frame;
  return loaded;
}

/// The moving transforms of a bag, each in the order of time.
std::map<Link, std::vector<StampedPose>> read_moving_transforms(const BagFile& bag) {
  std::map<Link, std::vector<StampedPose>> links;
  for_each_message(
      bag, kTransforms,
      [&](const BagConnection& connection, const SerializedMessage& message, Timestamp recorded) {
        if (!is_transforms_type(connection.type)) return;
        for (const PoseMessage& transform : parse_transforms(message)) {
          if (!transform.pose) continue;
          links[{transform.header.frame, transform.child}].push_back(
              {stamp_or(transform.header.stamp, recorded), *transform.pose});
        }
      });
  for (auto& [link, poses] : links) poses = sorted_trajectory(std::move(poses), {}).trajectory.poses;
  return links;
}

bool is_constant(const std::vector<StampedPose>& poses) {
  const Pose& first = poses.front().T_w_f;
  return std::ranges::all_of(poses, [&first](const StampedPose& pose) {
    return pose.T_w_f.p == first.p && pose.T_w_f.q.coeffs() == first.q.coeffs();
  });
}

/// The transform at a time between two of its messages.
std::optional<Pose> pose_at(const std::vector<StampedPose>& poses, Timestamp t) {
  const auto next = std::ranges::lower_bound(poses, t, {}, &StampedPose::t);
  if (next == poses.end()) return std::nullopt;
  if (next->t == t) return next->T_w_f;
  if (next == poses.begin()) return std::nullopt;
  const StampedPose& last = *std::prev(next);
  const double interval = seconds_between(last.t, next->t);
  if (interval > kMaxInterpolation_s) return std::nullopt;
  return interpolate(last.T_w_f, next->T_w_f, seconds_between(last.t, t) / interval);
}

std::string list_of(const std::map<Link, std::vector<StampedPose>>& links) {
  std::string text;
  for (const auto& [link, poses] : links) text += (text.empty() ? "" : ", ") + link.first + "." + link.second;
  return text.empty() ? "none" : text;
}

/// The moving links whose value changes the pose of `child` in `parent`.
std::vector<Link> links_between(const std::map<Link, std::vector<StampedPose>>& moving,
                                const std::vector<NamedTransform>& all, const std::string& parent,
                                const std::string& child) {
  std::vector<Link> path;
  for (const auto& entry : moving) {
    const Link& link = entry.first;
    // A tree has one path: without one of its links, the frames are not connected.
    std::vector<NamedTransform> others;
    std::ranges::copy_if(all, std::back_inserter(others), [&link](const NamedTransform& other) {
      return other.parent != link.first || other.child != link.second;
    });
    if (!find_transform(others, parent, child)) path.push_back(link);
  }
  return path;
}

/// The poses of `child` in `parent` at the times of the link with the most messages.
eval::LoadedTrajectory chained_poses(const std::map<Link, std::vector<StampedPose>>& moving,
                                     const std::vector<Link>& path, const std::vector<NamedTransform>& fixed,
                                     const Link& ends) {
  const Link& fastest =
      *std::ranges::max_element(path, {}, [&moving](const Link& link) { return moving.at(link).size(); });
  std::vector<StampedPose> poses;
  eval::RowRepairs repairs;
  repairs.skip_reason = "a link of /tf without a transform within 1 s";
  for (const StampedPose& sample : moving.at(fastest)) {
    std::vector<NamedTransform> now = fixed;
    for (const Link& link : path) {
      if (const std::optional<Pose> pose = pose_at(moving.at(link), sample.t))
        now.push_back({.parent = link.first, .child = link.second, .T_parent_child = *pose});
    }
    if (const std::optional<Pose> pose = find_transform(now, ends.first, ends.second)) {
      poses.push_back({sample.t, *pose});
    } else {
      ++repairs.skipped;
    }
  }
  return sorted_trajectory(std::move(poses), repairs);
}

/// Removes the links that never change from a path on which others do, and adds them to the fixed ones: some
/// publishers send them once, or rarely.
void fix_constant_links(const std::map<Link, std::vector<StampedPose>>& moving, std::vector<Link>& path,
                        std::vector<NamedTransform>& fixed) {
  const auto never_changes = [&moving](const Link& link) { return is_constant(moving.at(link)); };
  if (std::ranges::all_of(path, never_changes)) return;
  for (const Link& link : path) {
    if (never_changes(link))
      fixed.push_back(
          {.parent = link.first, .child = link.second, .T_parent_child = moving.at(link).front().T_w_f});
  }
  std::erase_if(path, never_changes);
}

eval::LoadedTrajectory trajectory_of_frames(const BagFile& bag, const std::string& parent,
                                            const std::string& child) {
  const std::map<Link, std::vector<StampedPose>> moving = read_moving_transforms(bag);
  std::vector<NamedTransform> fixed = read_static_transforms(bag);
  std::vector<NamedTransform> links = fixed;
  for (const auto& [link, poses] : moving)
    links.push_back({.parent = link.first, .child = link.second, .T_parent_child = poses.front().T_w_f});
  if (!find_transform(links, parent, child))
    throw InputError(bag.path().string() + ":/tf", "no chain of transforms connects \"" + parent +
                                                       "\" and \"" + child + "\"; the moving ones are " +
                                                       list_of(moving));
  std::vector<Link> path = links_between(moving, links, parent, child);
  if (path.empty())
    throw InputError(bag.path().string() + ":/tf", "\"" + child + "\" does not move in \"" + parent +
                                                       "\"; the moving transforms are " + list_of(moving));
  fix_constant_links(moving, path, fixed);
  eval::LoadedTrajectory loaded = chained_poses(moving, path, fixed, {parent, child});
  loaded.trajectory.frame = child;
  return loaded;
}

}  // namespace

bool is_trajectory_type(std::string_view type) { return is_pose_type(type) || type == kNavSatFix; }

std::optional<BagTopic> parse_bag_topic(const std::string& text) {
  for (std::size_t separator = text.find(':'); separator != std::string::npos;
       separator = text.find(':', separator + 1)) {
    if (!eval::is_bag(text.substr(0, separator))) continue;
    const std::string topic = text.substr(separator + 1);
    return BagTopic{.bag = text.substr(0, separator), .topic = (topic.starts_with('/') ? "" : "/") + topic};
  }
  return std::nullopt;
}

std::vector<NamedTransform> read_static_transforms(const BagFile& bag) {
  std::map<Link, Pose> links;
  for_each_message(bag, kStaticTransforms,
                   [&](const BagConnection& connection, const SerializedMessage& message, Timestamp) {
                     if (!is_transforms_type(connection.type)) return;
                     for (const PoseMessage& transform : parse_transforms(message)) {
                       if (transform.pose) links[{transform.header.frame, transform.child}] = *transform.pose;
                     }
                   });
  std::vector<NamedTransform> transforms;
  transforms.reserve(links.size());
  for (const auto& [link, pose] : links)
    transforms.push_back({.parent = link.first, .child = link.second, .T_parent_child = pose});
  return transforms;
}

std::vector<NamedTransform> read_fixed_transforms(const BagFile& bag) {
  std::vector<NamedTransform> transforms = read_static_transforms(bag);
  const std::size_t of_static_topic = transforms.size();
  for (const auto& [link, poses] : read_moving_transforms(bag)) {
    const auto same_link = [&link](const NamedTransform& known) {
      return known.parent == link.first && known.child == link.second;
    };
    if (poses.size() > 1 && is_constant(poses) &&
        std::none_of(transforms.begin(), transforms.begin() + static_cast<std::ptrdiff_t>(of_static_topic),
                     same_link))
      transforms.push_back(
          {.parent = link.first, .child = link.second, .T_parent_child = poses.front().T_w_f});
  }
  return transforms;
}

eval::LoadedTrajectory read_bag_trajectory(const BagFile& bag, const std::string& topic) {
  eval::LoadedTrajectory loaded;
  if (topic.starts_with(kTransformsOfFrames)) {
    const std::string frames = topic.substr(kTransformsOfFrames.size());
    const std::size_t separator = frames.find('.');
    if (separator == std::string::npos)
      throw InputError(bag.path().string() + ":" + topic,
                       "has no child frame; expected /tf:PARENT.CHILD, e.g. /tf:map.base_link");
    loaded = trajectory_of_frames(bag, frames.substr(0, separator), frames.substr(separator + 1));
  } else {
    loaded = trajectory_of_topic(bag, topic);
  }
  if (loaded.trajectory.poses.empty()) {
    std::set<std::string> topics;
    for (const BagConnection& connection : bag.connections()) {
      if (is_trajectory_type(connection.type) || is_transforms_type(connection.type))
        topics.insert(connection.topic);
    }
    std::string text;
    for (const std::string& name : topics) text += (text.empty() ? "" : ", ") + name;
    throw InputError(bag.path().string() + ":" + topic,
                     "contains no poses; the topics with poses are " + (text.empty() ? "none" : text));
  }
  return loaded;
}

std::vector<eval::StampedCovariance> read_bag_covariances(const BagTopic& source) {
  std::vector<eval::StampedCovariance> covariances;
  const BagFile bag(source.bag);
  for_each_message(
      bag, source.topic,
      [&](const BagConnection& connection, const SerializedMessage& message, Timestamp recorded) {
        if (!is_pose_type(connection.type)) return;
        const PoseMessage pose = parse_pose(message, connection.type);
        if (pose.covariance)
          covariances.push_back(eval::covariance_of(stamp_or(pose.header.stamp, recorded), *pose.covariance));
      });
  return covariances;
}

eval::LoadedTrajectory read_bag_trajectory(const BagTopic& source) {
  return read_bag_trajectory(BagFile(source.bag), source.topic);
}

namespace {

constexpr std::string_view kCameraInfo = "sensor_msgs/CameraInfo";

/// "/camera/color" of "/camera/color/image_raw/compressed".
std::string camera_name(std::string topic) {
  for (const std::string_view transport : {"/compressedDepth", "/compressed"}) {
    if (topic.ends_with(transport)) topic.resize(topic.size() - transport.size());
  }
  return topic.substr(0, topic.rfind('/'));
}

std::optional<CameraInfoMessage> calibrated(const BagFile& bag, const MessageReference& reference) {
  const std::string bytes = bag.payload(reference);
  const std::string place = bag.place(reference);
  const CameraInfoMessage info =
      parse_camera_info({.bytes = bytes, .format = bag.connection(reference).format, .place = place});
  return info.K[0] > 0.0 && info.K[4] > 0.0 ? std::optional(info) : std::nullopt;
}

}  // namespace

std::optional<CameraInfoMessage> find_camera_info(const BagFile& bag, const std::string& image_topic,
                                                  const std::string& image_frame) {
  const std::string beside = camera_name(image_topic) + "/camera_info";
  const std::string of_stream = realsense_stream(image_topic).value_or("") + "/info/camera_info";
  std::set<std::string> seen;
  std::optional<CameraInfoMessage> of_frame;
  for (const MessageReference& reference : bag.messages()) {
    const BagConnection& connection = bag.connection(reference);
    if (connection.type != kCameraInfo || !seen.insert(connection.topic).second) continue;
    std::optional<CameraInfoMessage> info = calibrated(bag, reference);
    if (connection.topic == beside || connection.topic == of_stream) return info;
    if (info && !of_frame && !image_frame.empty() && info->header.frame == image_frame) of_frame = info;
  }
  return of_frame;
}

namespace {

/// The camera of the images, from that of the full image: by the region of interest, then by the binning,
/// which divides the principal point (image_geometry::PinholeCameraModel). A region that is not within the
/// full image is that of a sensor of another size: `info` then describes the images themselves.
Camera with_region(Camera camera, const CameraInfoMessage& info) {
  const ImageRegion& region = info.region;
  const bool is_part = region.width > 0 && region.height > 0 &&
                       std::uint64_t{region.x} + region.width <= info.width &&
                       std::uint64_t{region.y} + region.height <= info.height;
  if (is_part) {
    camera.width = static_cast<int>(region.width);
    camera.height = static_cast<int>(region.height);
    camera.cx -= region.x;
    camera.cy -= region.y;
  }
  const auto bin = [](std::uint32_t binning, int& size, double& focal_length, double& center) {
    if (binning < 2 || binning > static_cast<std::uint32_t>(size)) return;
    size /= static_cast<int>(binning);
    focal_length /= binning;
    center /= binning;
  };
  bin(info.binning_x, camera.width, camera.fx, camera.cx);
  bin(info.binning_y, camera.height, camera.fy, camera.cy);
  return camera;
}

/// "/camera/image_rect_color", "/camera/rectified/image": a word that begins with "rect".
bool has_rectified_images(const std::string& topic) {
  return topic.find("_rect") != std::string::npos || topic.find("/rect") != std::string::npos;
}

}  // namespace

Camera camera_of(const CameraInfoMessage& info, const std::string& image_topic, const std::string& place) {
  Camera camera{.width = static_cast<int>(info.width),
                .height = static_cast<int>(info.height),
                .fx = info.K[0],
                .fy = info.K[4],
                .cx = info.K[2],
                .cy = info.K[5]};
  const bool is_rectified = has_rectified_images(image_topic) && info.P[0] > 0.0;
  if (is_rectified) {
    camera.fx = info.P[0];
    camera.fy = info.P[5];
    camera.cx = info.P[2];
    camera.cy = info.P[6];
  }
  camera = with_region(camera, info);
  if (is_rectified) return camera;
  if (std::ranges::all_of(info.D, [](double coefficient) { return coefficient == 0.0; })) return camera;
  return with_lens(camera, {.name = info.distortion_model, .coefficients = info.D}, place);
}

std::optional<std::string> realsense_stream(const std::string& topic) {
  if (!topic.starts_with("/device_")) return std::nullopt;
  const std::size_t sensor = topic.find("/sensor_", 1);
  const std::size_t stream = sensor == std::string::npos ? sensor : topic.find('/', sensor + 1);
  if (stream == std::string::npos) return std::nullopt;
  return topic.substr(0, topic.find('/', stream + 1));
}

RealsenseStreams read_realsense_streams(const BagFile& bag) {
  RealsenseStreams streams;
  for (const MessageReference& reference : bag.messages()) {
    const BagConnection& connection = bag.connection(reference);
    const bool is_extrinsic = connection.type == "geometry_msgs/Transform";
    // Written with a space or an underscore, depending on the version.
    const bool is_unit = connection.type == "std_msgs/Float32" &&
                         (connection.topic.find("Depth Units/value") != std::string::npos ||
                          connection.topic.find("Depth_Units/value") != std::string::npos);
    const std::optional<std::string> stream = realsense_stream(connection.topic);
    if (!stream || (!is_extrinsic && !is_unit)) continue;
    const std::string bytes = bag.payload(reference);
    const std::string place = bag.place(reference);
    const SerializedMessage message{.bytes = bytes, .format = connection.format, .place = place};
    if (is_unit) {
      const double meters = parse_float(message);
      if (meters > 0.0) streams.depth_units_per_m = 1.0 / meters;
    } else if (const std::optional<Pose> pose = parse_transform(message)) {
      streams.links.push_back({.parent = connection.topic.substr(connection.topic.rfind('/') + 1),
                               .child = *stream,
                               .T_parent_child = *pose});
    }
  }
  return streams;
}

}  // namespace stillpoint::datasets
