// SPDX-License-Identifier: BSD-3-Clause
/// The extension module `stillpoint._datasets`: sequences of any format as arrays, frames, and calibration.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "bench/python/arrays.h"
#include "bench/python/records.h"
#include "core/types/frame.h"
#include "core/types/rig.h"
#include "datasets/bags/bag_geometry.h"
#include "datasets/open_sequence.h"
#include "datasets/sensor_stream.h"
#include "datasets/sequence_export.h"

namespace stillpoint::python {
namespace {

using datasets::SensorStream;
using datasets::SequenceInfo;

/// A view of the pixels, [height, width] or [height, width, 3], that keeps them alive; None without an image.
py::object image_array(const cv::Mat& image) {
  if (image.empty()) return py::none();
  const py::capsule owner(new cv::Mat(image), [](void* mat) { delete static_cast<cv::Mat*>(mat); });
  const auto rows = static_cast<py::ssize_t>(image.rows);
  const auto columns = static_cast<py::ssize_t>(image.cols);
  const auto step = static_cast<py::ssize_t>(image.step[0]);
  if (image.type() == CV_16UC1) return view(image.ptr<std::uint16_t>(), {rows, columns}, {step, 2}, owner);
  if (image.type() == CV_8UC3)
    return view(image.ptr<std::uint8_t>(), {rows, columns, 3}, {step, 3, 1}, owner);
  return view(image.ptr<std::uint8_t>(), {rows, columns}, {step, 1}, owner);
}

/// A copy of an array as an image.
/// @throws InputError for another type or number of dimensions
cv::Mat image_of(const py::object& object, const char* name, int type) {
  if (object.is_none()) return {};
  const auto array = py::array::ensure(object, py::array::c_style);
  const bool deep = type == CV_16UC1;
  const py::ssize_t dimensions = type == CV_8UC3 ? 3 : 2;
  const bool has_type = array && (deep ? py::isinstance<py::array_t<std::uint16_t>>(array)
                                       : py::isinstance<py::array_t<std::uint8_t>>(array));
  if (!has_type || array.ndim() != dimensions || (dimensions == 3 && array.shape(2) != 3)) {
    throw InputError(name, std::string("is no array ") +
                               (dimensions == 3 ? "[height, width, 3]" : "[height, width]") + " of " +
                               (deep ? "uint16" : "uint8"));
  }
  return cv::Mat(static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)), type,
                 const_cast<void*>(array.data()))  // NOLINT: copied at once
      .clone();
}

Frame frame_of(std::int64_t t_ns, const py::object& gray, const py::object& depth, const py::object& color,
               double depth_units_per_m, std::int64_t id) {
  return {.id = id,
          .t = Timestamp{t_ns},
          .gray = image_of(gray, "gray", CV_8UC1),
          .color = image_of(color, "color", CV_8UC3),
          .depth = image_of(depth, "depth", CV_16UC1),
          .depth_units_per_m = depth_units_per_m};
}

void bind_frame(py::module_& m) {
  py::class_<Frame>(m, "Frame",
                    "One frame of an RGB-D camera. The images are read-only views; None: there is none.")
      .def(py::init(&frame_of), py::arg("t_ns"), py::arg("gray"), py::arg("depth") = py::none(),
           py::arg("color") = py::none(), py::arg("depth_units_per_m") = 1000.0, py::arg("id") = 0,
           "From arrays, which are copied: gray uint8 [height, width], depth uint16 [height, width], 0 = not "
           "measured, "
           "color uint8 [height, width, 3], RGB.")
      .def_readonly("id", &Frame::id, "Position in the sequence, from 0.")
      .def_property_readonly(
          "t_ns", [](const Frame& frame) { return frame.t.ns; }, "Stamp, ns.")
      .def_property_readonly(
          "gray", [](const Frame& frame) { return image_array(frame.gray); }, "uint8 [height, width].")
      .def_property_readonly(
          "color", [](const Frame& frame) { return image_array(color_image(frame)); },
          "uint8 [height, width, 3], RGB.")
      .def_property_readonly(
          "depth", [](const Frame& frame) { return image_array(frame.depth); },
          "uint16 [height, width]; 0 = not measured.")
      .def_readonly("depth_units_per_m", &Frame::depth_units_per_m, "Depth value of 1 m.");
}

void bind_rig(py::module_& m) {
  Options<Camera>(m, "Camera", "Intrinsics, px, and distortion coefficients.")
      .field("width", &Camera::width, "px.")
      .field("height", &Camera::height, "px.")
      .field("fx", &Camera::fx, "px.")
      .field("fy", &Camera::fy, "px.")
      .field("cx", &Camera::cx, "px.")
      .field("cy", &Camera::cy, "px.")
      .choice("model", &Camera::model, "radial-tangential or kannala-brandt.")
      .field("distortion", &Camera::distortion,
             "Eight coefficients; k1 k2 p1 p2 k3 k4 k5 k6, or k1 k2 k3 k4.");
  Options<ImuNoise>(m, "ImuNoise", "Continuous-time noise densities.")
      .field("gyro_noise", &ImuNoise::gyro_noise, "rad/s/sqrt(Hz).")
      .field("accel_noise", &ImuNoise::accel_noise, "m/s^2/sqrt(Hz).")
      .field("gyro_walk", &ImuNoise::gyro_walk, "rad/s^2/sqrt(Hz).")
      .field("accel_walk", &ImuNoise::accel_walk, "m/s^3/sqrt(Hz).");
  Options<Rig>(m, "Rig", "Calibration of the sensors.")
      .field("camera", &Rig::camera, "Camera.")
      .field("depth_units_per_m", &Rig::depth_units_per_m, "Depth value of 1 m.")
      .field("has_imu", &Rig::has_imu, "Whether there is an IMU.")
      .property("T_b_c",
                std::pair([](const Rig& rig) { return matrix_array(rig.T_b_c.matrix()); },
                          [](Rig& rig, const Doubles& T) { rig.T_b_c = rigid_of(T, "T_b_c"); }),
                "Pose of the camera in the body (IMU), [4, 4].")
      .field("imu_noise", &Rig::imu_noise, "ImuNoise.")
      .field("time_offset_s", &Rig::time_offset_s, "IMU time of an exposure minus its stamp, s.")
      .field("rolling_shutter_s", &Rig::rolling_shutter_s, "Readout time from the first to the last row, s.");
}

/// Recorded boxes of one image.
void bind_detections(py::module_& m) {
  py::class_<DetectionSet>(m, "DetectionSet", "Boxes of one image.")
      .def(py::init([](std::int64_t t_ns, const std::vector<std::tuple<std::string, double, std::array<double, 4>>>& boxes) {
             DetectionSet set{.t = Timestamp{t_ns}, .state = DetectionState::kPresent};
             for (const auto& [name, score, box] : boxes)
               set.detections.push_back({name, score, {box[0], box[1], box[2], box[3]}});
             return set;
           }),
           py::arg("t_ns"), py::arg("boxes"), "Boxes (class name, score, (x_min, y_min, x_max, y_max) in px).")
      .def_property_readonly("t_ns", [](const DetectionSet& set) { return set.t.ns; }, "Stamp of the image, ns.")
      .def_property_readonly(
          "boxes",
          [](const DetectionSet& set) {
            std::vector<std::tuple<std::string, double, std::array<double, 4>>> boxes;
            for (const Detection& d : set.detections)
              boxes.emplace_back(d.class_name, d.score,
                                 std::array<double, 4>{d.box.x_min, d.box.y_min, d.box.x_max, d.box.y_max});
            return boxes;
          },
          "List of (class name, score, (x_min, y_min, x_max, y_max) in px).");
}

using Stream = std::unique_ptr<SensorStream>;

/// One column of the inertial samples, without a copy.
template <auto First, int width>
py::array imu_column(const py::object& self) {
  const std::vector<ImuSample>& imu = self.cast<const SensorStream&>().info().imu;
  return column(std::span<const ImuSample>(imu), imu.empty() ? nullptr : First(imu.front()), width, self);
}
const std::int64_t* imu_stamp(const ImuSample& sample) { return &sample.t.ns; }
const double* imu_gyro(const ImuSample& sample) { return sample.gyro_b.data(); }
const double* imu_accel(const ImuSample& sample) { return sample.accel_b.data(); }

Frame loaded_frame(const SensorStream& stream, py::ssize_t index) {
  const auto count = static_cast<py::ssize_t>(stream.info().frame_times.size());
  if (index < 0) index += count;
  if (index < 0 || index >= count) throw py::index_error("frame " + std::to_string(index));
  const py::gil_scoped_release release;
  return stream.load_frame(static_cast<std::size_t>(index));
}

/// Poses of the camera.
Trajectory camera_truth(const SensorStream& stream) {
  const datasets::GroundTruth& truth = stream.info().ground_truth;
  const Pose T_f_c = truth.T_c_f.inverse();
  Trajectory camera{.frame = "camera"};
  for (const StampedPose& pose : truth.trajectory.poses)
    camera.poses.emplace_back(pose.t, pose.T_w_f * T_f_c);
  return camera;
}

using SequenceClass = py::class_<SensorStream>;

SequenceClass bind_sequence(py::module_& m) {
  SequenceClass type(
      m, "Sequence",
      "A recorded or rendered sequence. Its elements are the frames, decoded when they are read.");
  type.def("__len__", [](const SensorStream& stream) { return stream.info().frame_times.size(); })
      .def("__getitem__", &loaded_frame, py::arg("index"), py::keep_alive<0, 1>(),
           "Decodes a frame. Raises InputError if an image is missing or damaged.")
      .def_property_readonly(
          "name", [](const SensorStream& stream) { return stream.info().name; }, "Name of the folder.")
      .def_property_readonly(
          "format", [](const SensorStream& stream) { return stream.info().format; }, "Name of the format.")
      .def_property_readonly(
          "rig", [](const SensorStream& stream) { return stream.info().rig; }, "Calibration.")
      .def_property_readonly(
          "frame_times_ns", [](const SensorStream& stream) { return stamp_array(stream.info().frame_times); },
          "Stamps of the frames, int64 [n], ns.")
      .def_property_readonly("imu_times_ns", &imu_column<imu_stamp, 1>,
                             "Stamps of the inertial samples, int64 [m], ns.")
      .def_property_readonly("gyro", &imu_column<imu_gyro, 3>, "Angular rates of the body, [m, 3], rad/s.")
      .def_property_readonly("accel", &imu_column<imu_accel, 3>,
                             "Specific forces of the body, [m, 3], m/s^2.")
      .def_property_readonly(
          "ground_truth", [](const SensorStream& stream) { return stream.info().ground_truth.trajectory; },
          "Poses of the frame that the dataset states; empty if there are none.")
      .def_property_readonly("camera_truth", &camera_truth, "The same of the camera, T_w_c.")
      .def_property_readonly(
          "detections", [](const SensorStream& stream) { return stream.info().detections; },
          "Recorded boxes, list of DetectionSet.")
      .def_property_readonly(
          "notes", [](const SensorStream& stream) { return stream.info().notes; },
          "Assumptions of the reader.")
      .def_property_readonly(
          "warnings", [](const SensorStream& stream) { return stream.info().warnings; },
          "Repaired faults of the files.");
  return type;
}

void bind_copies(SequenceClass& type) {
  type.def(
          "motion_labels",
          [](const SensorStream& stream, std::size_t index) -> py::object {
            if (index >= stream.info().frame_times.size())
              throw py::index_error("frame " + std::to_string(index));
            const std::optional<datasets::MotionLabels> labels = stream.load_labels(index);
            if (!labels) return py::none();
            return py::make_tuple(image_array(labels->object), image_array(labels->speed_cm_per_s));
          },
          py::arg("index"),
          "Object per pixel (0 = static scene) and its speed, cm/s, uint8 [height, width] each; None without "
          "labels.")
      .def(
          "write_tum",
          [](const SensorStream& stream, const std::filesystem::path& folder) {
            datasets::export_tum(stream, folder);
          },
          py::arg("folder"), "Writes the sequence in the TUM layout; the folder must not exist.",
          py::call_guard<py::gil_scoped_release>())
      .def(
          "write_bag",
          [](const SensorStream& stream, const std::filesystem::path& path, const std::string& compression) {
            datasets::export_bag(stream, path, compression);
          },
          py::arg("path"), py::arg("compression") = "none",
          "Writes the sequence as FILE.bag (ROS 1) or FILE.mcap; the file must not exist.",
          py::call_guard<py::gil_scoped_release>());
}

Stream opened(const std::filesystem::path& path, const std::string& format, const std::filesystem::path& rig,
              const std::vector<std::string>& topics) {
  return datasets::open_sequence(path, {.format = format, .rig_file = rig, .topics = topics});
}

void bind_opening(py::module_& m) {
  m.def("open_sequence", &opened, py::arg("path"), py::arg("format") = "", py::arg("rig") = "",
        py::arg("topics") = std::vector<std::string>{},
        "Opens a sequence folder or bag; the format is detected unless it is given. `rig`: a file that "
        "overrides the "
        "calibration; `topics` of a bag: ROLE=TOPIC. Raises InputError if it is no sequence, or a file in it "
        "is malformed.",
        py::call_guard<py::gil_scoped_release>());
  m.def("format_names", &datasets::sequence_format_names, "The names of all sequence formats.");
  m.def(
      "load_bag_trajectory",
      [](const std::string& path) -> std::optional<eval::LoadedTrajectory> {
        const std::optional<datasets::BagTopic> source = datasets::parse_bag_topic(path);
        if (!source) return std::nullopt;
        return datasets::read_bag_trajectory(*source);
      },
      py::arg("path"), "Poses of a topic of a bag, BAG:/TOPIC; None if the path is none.",
      py::call_guard<py::gil_scoped_release>());
}

}  // namespace
}  // namespace stillpoint::python

PYBIND11_MODULE(_datasets, module) {
  using namespace stillpoint::python;  // of the functions above
  module.doc() = "Sequences of any format; the public names are those of stillpoint.datasets.";
  pybind11::module_::import("stillpoint._eval");  // its types and its exception
  bind_rig(module);
  bind_frame(module);
  bind_detections(module);
  pybind11::class_<stillpoint::datasets::SensorStream> sequence = bind_sequence(module);
  bind_copies(sequence);
  bind_opening(module);
}
