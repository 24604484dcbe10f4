// SPDX-License-Identifier: BSD-3-Clause
/// The extension module `stillpoint._synth`: rendered sequences with exact ground truth.
#include <filesystem>
#include <string>

#include "bench/python/records.h"
#include "datasets/synthetic/sequence/render_sequence.h"
#include "datasets/synthetic/sequence/request_rig.h"

namespace stillpoint::python {
namespace {

using synth::SynthRequest;

void bind_sensors(py::module_& m) {
  using namespace synth;  // NOLINT(google-build-using-namespace): the sensors
  Options<ColorSensor>(m, "ColorSensor", "Color camera.")
      .field("exposure_s", &ColorSensor::exposure_s, "Exposure time, s; determines motion blur.")
      .field("read_noise", &ColorSensor::read_noise, "Standard deviation relative to saturation.")
      .field("shot_noise", &ColorSensor::shot_noise, "1 / well depth.")
      .field("vignetting", &ColorSensor::vignetting, "Fraction of the natural fall-off, in [0, 1].")
      .field("exposure_swing", &ColorSensor::exposure_swing, "Amplitude of slow changes, stops.")
      .field("exposure_period_s", &ColorSensor::exposure_period_s, "Their period, s.");
  Options<DepthSensor>(m, "DepthSensor", "Depth camera.")
      .field("noise_per_m", &DepthSensor::noise_per_m, "Standard deviation per squared depth, 1/m.")
      .field("correlated_fraction", &DepthSensor::correlated_fraction,
             "Of the standard deviation, in [0, 1].")
      .field("correlation_px", &DepthSensor::correlation_px, "Size of the matching window, px.")
      .field("focal_baseline_px_m", &DepthSensor::focal_baseline_px_m, "Focal length by baseline, px m.")
      .field("disparity_step_px", &DepthSensor::disparity_step_px, "Quantization, px; 0 = none.")
      .field("min_m", &DepthSensor::min_m, "Not measured below, m.")
      .field("max_m", &DepthSensor::max_m, "Not measured above, m.")
      .field("edge_dropout", &DepthSensor::edge_dropout, "Probability of a hole at an edge, in [0, 1].")
      .field("units_per_m", &DepthSensor::units_per_m, "Depth value of 1 m.");
  Options<ImuSensor>(m, "ImuSensor", "Inertial sensor.")
      .field("gyro_rate_hz", &ImuSensor::gyro_rate_hz, "Hz.")
      .field("accel_rate_hz", &ImuSensor::accel_rate_hz, "Hz.")
      .field("noise", &ImuSensor::noise, "datasets.ImuNoise.")
      .field("gyro_bias", &ImuSensor::gyro_bias, "Standard deviation of the first bias, rad/s.")
      .field("accel_bias", &ImuSensor::accel_bias, "Standard deviation of the first bias, m/s^2.")
      .field("time_offset_s", &ImuSensor::time_offset_s, "IMU stamp minus true time, s.");
  Options<DetectorModel>(m, "DetectorModel", "Simulated detector of people.")
      .field("miss_rate", &DetectorModel::miss_rate, "Fraction of missed frames, in [0, 1].")
      .field("burst_frames", &DetectorModel::burst_frames, "Mean length of a run of misses, frames.")
      .field("jitter_ratio", &DetectorModel::jitter_ratio, "Standard deviation of an edge per box size.")
      .field("false_positive_rate", &DetectorModel::false_positive_rate, "Fraction of the frames, in [0, 1].")
      .field("min_height_px", &DetectorModel::min_height_px, "Smaller people are not detected, px.");
}

void bind_request(py::module_& m) {
  Options<SynthRequest> options(
      m, "Request", "A sequence to render, as `preset` makes it. Equal requests give the same bits.");
  options.field("preset", &SynthRequest::preset, "Name.")
      .field("seed", &SynthRequest::seed, "Of the scene and all noise.")
      .field("seconds", &SynthRequest::seconds, "Duration, s.")
      .field("frames_per_s", &SynthRequest::frames_per_s, "Hz.")
      .field("width", &SynthRequest::width, "px.")
      .field("height", &SynthRequest::height, "px.")
      .field("focal_px", &SynthRequest::focal_px, "px.")
      .field("walkers", &SynthRequest::walkers, "Walking people.")
      .field("seated", &SynthRequest::seated, "Seated people.")
      .field("unknown_movers", &SynthRequest::unknown_movers,
             "Carts and chairs that the detector does not report.")
      .field("rolling_shutter_s", &SynthRequest::rolling_shutter_s,
             "Readout from the first to the last row, s.")
      .field("dropped_fraction", &SynthRequest::dropped_fraction, "Of the frames, in [0, 1].")
      .field("labels", &SynthRequest::labels, "Also an instance mask per frame, see Sequence.motion_labels.")
      .field("color", &SynthRequest::color, "ColorSensor.")
      .field("depth", &SynthRequest::depth, "DepthSensor.")
      .field("imu", &SynthRequest::imu, "ImuSensor.")
      .field("detector", &SynthRequest::detector, "DetectorModel.")
      .field("start_s", &SynthRequest::start_s, "First frame in a recorded motion, s.")
      .field("trajectory_file", &SynthRequest::trajectory_file,
             "Recorded motion of the presets that have one.")
      .field("imu_file", &SynthRequest::imu_file, "Inertial samples of the preset flight.")
      .field("track_sequence", &SynthRequest::track_sequence, "Number of the sequence of the preset track.")
      .field("times_file", &SynthRequest::times_file, "Recorded frame times; empty: equal intervals.")
      .field("mesh_file", &SynthRequest::mesh_file, "Scene of the preset mesh: PLY or OBJ.")
      .choice("layout", &SynthRequest::layout, "Of the files: openloris or tum.");
  options.type().def("use_rig", &synth::use_rig, py::arg("file"),
                     "Takes image size, calibration and noise of a rig file. Raises InputError.");
  options.type().def_property_readonly(
      "key", &synth::request_key,
      "Hash of the request and of the files that it names; that of a sequence in the cache.");
}

synth::RenderControl control_of(int threads) {
  if (threads < 0) throw InputError("threads", "must be 0 (one per processor) or more");
  return {.threads = threads};
}

void bind_rendering(py::module_& m) {
  m.def("preset_request", &synth::preset_request, py::arg("name"),
        "The Request of a preset with its defaults. Raises InputError if there is no such preset.");
  m.def("preset_names", &synth::preset_names, "The names of all presets.");
  m.def(
      "render_into",
      [](const SynthRequest& request, const std::filesystem::path& folder, int threads) {
        const synth::RenderControl control = control_of(threads);
        const py::gil_scoped_release release;
        synth::render_sequence(request, folder, control);
      },
      py::arg("request"), py::arg("folder"), py::arg("threads") = 0,
      "Writes the files of a sequence into a folder, which must not exist. `threads`: 0 = one per processor; "
      "they do not affect the result.");
  m.def(
      "render_cached",
      [](const SynthRequest& request, int threads) {
        const synth::RenderControl control = control_of(threads);
        const py::gil_scoped_release release;
        return synth::cached_sequence(request, control);
      },
      py::arg("request"), py::arg("threads") = 0,
      "The folder of the sequence in the cache of the program; renders the frames that it lacks.");
}

}  // namespace
}  // namespace stillpoint::python

PYBIND11_MODULE(_synth, module) {
  using namespace stillpoint::python;  // of the functions above
  module.doc() = "Rendered sequences; the public names are those of stillpoint.synth.";
  pybind11::module_::import("stillpoint._datasets");  // its types, and the exception
  bind_sensors(module);
  bind_request(module);
  bind_rendering(module);
}
