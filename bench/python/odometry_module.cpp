// SPDX-License-Identifier: BSD-3-Clause
/// The extension module `stillpoint._odometry`: the odometry fed with samples and frames.
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/python/arrays.h"
#include "bench/python/records.h"
#include "core/config/odometry_config.h"
#include "core/detector/playback_detectors.h"
#include "core/pipeline/odometry.h"
#include "core/pipeline/stages/frame_report.h"

namespace stillpoint::python {
namespace {

/// Sets the members of a config from a dict of tables, as in a TOML file.
/// @throws InputError for an unknown key, another type, or a value out of range
template <class Config>
void assign(Config& config, const py::dict& values, const std::string& prefix);

[[noreturn]] void reject(const std::string& key, const char* problem, const py::handle& value) {
  throw InputError(key, problem + std::string(": ") + py::repr(value).cast<std::string>());
}

template <class Member>
void assign_member(Member& member, const py::handle& value, const std::string& key) {
  if constexpr (requires { enum_names(Member{}); }) {
    member = value_of<Member>(key, value.cast<std::string>());
  } else if constexpr (requires(Member & section) { visit_fields([](auto&&...) {}, section); }) {
    if (!py::isinstance<py::dict>(value)) reject(key, "has a value of another type", value);
    assign(member, py::reinterpret_borrow<py::dict>(value), key + ".");
  } else {
    member = value.cast<Member>();
  }
}

template <class Config>
void assign(Config& config, const py::dict& values, const std::string& prefix) {
  py::set known;
  visit_fields(
      [&](std::string_view name, auto& member, const auto&... info) {
        const py::str field{std::string(name)};
        known.add(field);
        if (!values.contains(field)) return;
        const std::string key = prefix + std::string(name);
        try {
          assign_member(member, values[field], key);
        } catch (const py::cast_error&) {
          reject(key, "has a value of another type", values[field]);
        }
        if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(member)>> && sizeof...(info) == 1) {
          const FieldInfo& bounds = std::get<0>(std::tie(info...));
          if (!(static_cast<double>(member) >= bounds.min && static_cast<double>(member) <= bounds.max))
            reject(key, "is out of range", values[field]);
        }
      },
      config);
  for (const std::pair<py::handle, py::handle> item : values) {
    if (!known.contains(item.first))
      throw InputError(prefix + item.first.cast<std::string>(), "is no key of the config");
  }
}

void bind_update(py::module_& m) {
  using Update = OdometryUpdate;
  Record<Update>(m, "OdometryUpdate", "Result of one frame. The pose is valid only if it is located.")
      .field("frame_id", &Update::frame_id, "Of the frame.")
      .field(
          "t_ns", [](const Update& u) { return u.state.t.ns; }, "Stamp of the state, ns.")
      .field(
          "status", [](const Update& u) { return std::string(status_name(u.status)); },
          "initializing, tracking, degraded, dead_reckoning, lost or relocated.")
      .field(
          "reason", [](const Update& u) { return std::string(reason_name(u.reason)); },
          "For the status; may be empty.")
      .field(
          "is_located", [](const Update& u) { return is_located(u.status); },
          "Whether the pose is valid by vision.")
      .field("segment", &Update::segment, "Number of the world frame.")
      .field(
          "T_w_c", [](const Update& u) { return matrix_array(u.T_w_c.matrix()); },
          "Pose of the camera, [4, 4].")
      .field(
          "T_w_b", [](const Update& u) { return matrix_array(u.state.T_w_b.matrix()); },
          "Pose of the body, [4, 4].")
      .field(
          "position", [](const Update& u) { return vector_array(u.T_w_c.p); }, "Of the camera, [3], m.")
      .field(
          "quaternion_xyzw", [](const Update& u) { return quaternion_array(u.T_w_c.q); },
          "Of the camera, [4].")
      .field(
          "velocity", [](const Update& u) { return vector_array(u.state.v_w); }, "Of the body, [3], m/s.")
      .field(
          "gyro_bias", [](const Update& u) { return vector_array(u.state.gyro_bias); }, "[3], rad/s.")
      .field(
          "accel_bias", [](const Update& u) { return vector_array(u.state.accel_bias); }, "[3], m/s^2.")
      .field(
          "covariance",
          [](const Update& u) -> py::object {
            if (!u.covariance) return py::none();
            return matrix_array(u.covariance->state);
          },
          "[15, 15] of position (world), rotation (body), velocity, and biases of gyroscope and "
          "accelerometer; None if it "
          "was not computed.")
      .field("time_offset_s", &Update::time_offset_s, "Current estimate, s.")
      .field("depth_scale", &Update::depth_scale, "Measured by true depth; current estimate.")
      .field(
          "tracked_features", [](const Update& u) { return u.counters.tracked_features; },
          "Received from the tracker.")
      .field(
          "window_landmarks", [](const Update& u) { return u.counters.window_landmarks; },
          "In the optimization.")
      .field(
          "dynamic_features", [](const Update& u) { return u.counters.dynamic_features; },
          "Excluded as dynamic.")
      .field(
          "is_keyframe", [](const Update& u) { return u.counters.keyframe; },
          "Whether the frame is a keyframe.");
}

/// Adds samples [n] in one call.
void add_samples(Odometry& odometry, const py::object& times_ns, const Doubles& gyro, const Doubles& accel) {
  const std::vector<Timestamp> stamps = stamps_of(times_ns, "times_ns");
  const auto count = static_cast<py::ssize_t>(stamps.size());
  require_shape(gyro, "gyro", {count, 3});
  require_shape(accel, "accel", {count, 3});
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    odometry.add_imu({.t = stamps[i],
                      .gyro_b = Eigen::Map<const Eigen::Vector3d>(gyro.data() + 3 * i),
                      .accel_b = Eigen::Map<const Eigen::Vector3d>(accel.data() + 3 * i)});
  }
}

/// The features of the newest frame as columns.
py::dict feature_columns(const Odometry& odometry) {
  std::vector<std::int64_t> ids;
  std::vector<std::int64_t> ages;
  std::vector<double> pixels;
  std::vector<double> bearings;
  std::vector<double> depths;
  py::list labels;
  std::map<std::int64_t, LabelClass> label_of;
  for (const DynamicLabel& label : odometry.dynamic().labels) label_of.emplace(label.id, label.label);
  for (const TrackedFeature& feature : odometry.tracked().features) {
    ids.push_back(feature.id);
    ages.push_back(feature.age);
    pixels.insert(pixels.end(), {feature.pixel.x(), feature.pixel.y()});
    bearings.insert(bearings.end(), {feature.bearing.x(), feature.bearing.y()});
    depths.push_back(feature.depth);
    const auto label = label_of.find(feature.id);
    labels.append(label == label_of.end() ? std::string() : std::string(label_name(label->second)));
  }
  py::dict columns;
  columns["id"] = array_of(std::move(ids));
  columns["age"] = array_of(std::move(ages));
  columns["pixel"] = table_of(std::move(pixels), 2);
  columns["bearing"] = table_of(std::move(bearings), 2);
  columns["depth"] = array_of(std::move(depths));
  columns["label"] = labels;
  return columns;
}

/// A detector and the boxes that it plays back.
class Playback {
 public:
  explicit Playback(std::vector<DetectionSet> sets)
      : sets_(std::move(sets)), detector_(sets_, kMaxDetectionOffset_s) {}
  Playback(const Playback&) = delete;
  Playback& operator=(const Playback&) = delete;

  DetectionSet detect(const Frame& frame) { return detector_.detect(frame); }

 private:
  std::vector<DetectionSet> sets_;
  RecordedDetector detector_;
};

void bind_detector(py::module_& m) {
  py::class_<Playback>(m, "RecordedDetector", "Plays recorded boxes back, as the program does.")
      .def(py::init<std::vector<DetectionSet>>(), py::arg("detections"),
           "From boxes in order of time, e.g. Sequence.detections.")
      .def("detect", &Playback::detect, py::arg("frame"),
           "The boxes nearest in time, at most 16 ms from the frame, clipped to the image; none if there are "
           "no such.");
}

void bind_odometry(py::module_& m) {
  py::class_<Odometry>(
      m, "Odometry",
      "Odometry for a program with its own sensor loop. One thread at a time may use an object. The same "
      "samples, frames and detections give bit-identical results.")
      .def(py::init([](const py::dict& config, const Rig& rig) {
             OdometryConfig values;
             assign(values, config, "");
             return std::make_unique<Odometry>(values, rig);
           }),
           py::arg("config"), py::arg("rig"),
           "config: tables of the config keys, see stillpoint.load_config; others have the defaults of "
           "the program. Raises "
           "InputError for an unknown key, a value out of range, or a rig that lacks a sensor.")
      .def(
          "add_imu",
          [](Odometry& odometry, std::int64_t t_ns, const Doubles& gyro, const Doubles& accel) {
            odometry.add_imu({.t = Timestamp{t_ns},
                              .gyro_b = vector_of(gyro, "gyro"),
                              .accel_b = vector_of(accel, "accel")});
          },
          py::arg("t_ns"), py::arg("gyro"), py::arg("accel"),
          "Adds a sample: angular rate [3], rad/s, and specific force [3], m/s^2, of the body.")
      .def("add_imu_samples", &add_samples, py::arg("times_ns"), py::arg("gyro"), py::arg("accel"),
           "Adds samples: int64 [n], ns, [n, 3] and [n, 3].")
      .def(
          "needs_imu_until",
          [](const Odometry& odometry, std::int64_t t_ns) {
            return odometry.needs_imu_until(Timestamp{t_ns}).ns;
          },
          py::arg("t_ns"),
          "Time, ns, that the samples must have reached before a frame with this stamp is tracked.")
      .def(
          "enters_window",
          [](const Odometry& odometry, std::int64_t t_ns) { return odometry.enters_window(Timestamp{t_ns}); },
          py::arg("t_ns"),
          "Whether the next frame, with this stamp, would be optimized; others need no detections.")
      .def(
          "track",
          [](Odometry& odometry, const Frame& frame, const DetectionSet& detections) -> OdometryUpdate {
            return odometry.track(frame, detections);
          },
          py::arg("frame"), py::arg("detections") = DetectionSet{},
          "Processes the next frame. Raises InputError for one of another size, or earlier than the previous "
          "one.",
          py::call_guard<py::gil_scoped_release>())
      .def("features", &feature_columns,
           "Features of the newest frame by name: id and age [n], pixel [n, 2], bearing [n, 2], depth [n], m "
           "(0 = not "
           "measured), label (stable, dynamic_object, dynamic_motion; empty for a frame that is not "
           "optimized).")
      .def_property_readonly(
          "imu_health",
          [](const Odometry& odometry) {
            const ImuHealth& health = odometry.imu_health();
            return std::pair(health.rejected_samples, health.gaps);
          },
          "Rejected samples, and gaps longer than 50 ms.");
}

}  // namespace
}  // namespace stillpoint::python

PYBIND11_MODULE(_odometry, module) {
  using namespace stillpoint::python;  // of the functions above
  module.doc() = "The odometry; the public names are those of stillpoint.";
  pybind11::module_::import("stillpoint._datasets");  // frames, calibration, detections
  bind_update(module);
  bind_detector(module);
  bind_odometry(module);
}
