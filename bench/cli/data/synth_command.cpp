// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <iostream>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "core/base/error.h"
#include "datasets/synthetic/sequence/render_sequence.h"
#include "datasets/synthetic/sequence/request_rig.h"

namespace stillpoint::bench {
namespace {

constexpr const char* kPresets =
    "walking_{xyz,static,rpy,halfsphere}, market, corridor, each also with _empty; fr3, "
    "fr3_{walking_{xyz,static,rpy,halfsphere},sitting_static}; track; flight"
    " (all recorded motion); mesh (a scan, the default with --mesh); with returns to places: "
    "{office,corridor,market}_laps, twin_aisles, changed_room, each also with _short; home_tour";
constexpr double kPresetValue = -1.0;  // option not given: use the value of the preset

/// Command line arguments of `data synth`.
struct SynthArguments {
  std::string preset;
  std::string out;
  std::string layout = "openloris";
  std::string trajectory, imu, times, mesh, rig;
  int track_sequence = 0;
  bool labels = false;
  int seed = 1;
  int threads = 0;
  int people = -1, seated = -1, unknown = -1;
  int width = -1, height = -1;
  double seconds = kPresetValue, rate = kPresetValue, focal = kPresetValue;
  double exposure_ms = kPresetValue, exposure_swing = kPresetValue, rolling_ms = kPresetValue;
  double start = kPresetValue;
  double time_offset_ms = std::numeric_limits<double>::quiet_NaN();  ///< not given; any number is a value
  double depth_noise = kPresetValue, depth_units = kPresetValue, dropped = kPresetValue;
};

template <class Value, class Given>
void override_with(Value& value, Given given, double factor = 1.0) {
  if (given >= 0) value = static_cast<Value>(given * factor);
}

std::string preset_of(const SynthArguments& arguments) {
  if (arguments.preset.empty() && arguments.mesh.empty())
    throw InputError("command line",
                     "PRESET is missing; give one, or a scene: --mesh FILE --trajectory FILE");
  return arguments.preset.empty() ? "mesh" : arguments.preset;
}

void use_rig_file(const SynthArguments& arguments, synth::SynthRequest& request) {
  if (arguments.width >= 0 || arguments.height >= 0 || arguments.focal >= 0)
    throw InputError("--rig", "states the camera; remove --width, --height and --focal, or --rig");
  synth::use_rig(request, arguments.rig);
}

synth::SynthRequest request_of(const SynthArguments& arguments) {
  synth::SynthRequest request = synth::preset_request(preset_of(arguments));
  request.layout = enum_of<synth::SequenceLayout>("--layout", arguments.layout);
  request.labels = arguments.labels;
  if (!arguments.trajectory.empty()) request.trajectory_file = arguments.trajectory;
  request.imu_file = arguments.imu;
  if (!arguments.times.empty()) request.times_file = arguments.times;
  request.track_sequence = arguments.track_sequence;
  request.mesh_file = arguments.mesh;
  if (!arguments.rig.empty()) use_rig_file(arguments, request);
  if (!std::isnan(arguments.time_offset_ms)) request.imu.time_offset_s = 1e-3 * arguments.time_offset_ms;
  override_with(request.seed, arguments.seed);
  override_with(request.seconds, arguments.seconds);
  override_with(request.start_s, arguments.start);
  override_with(request.frames_per_s, arguments.rate);
  override_with(request.walkers, arguments.people);
  override_with(request.seated, arguments.seated);
  override_with(request.unknown_movers, arguments.unknown);
  // The field of view remains constant.
  override_with(request.focal_px, arguments.width, request.focal_px / request.width);
  override_with(request.width, arguments.width);
  override_with(request.height, arguments.height);
  override_with(request.focal_px, arguments.focal);
  override_with(request.color.exposure_s, arguments.exposure_ms, 1e-3);
  override_with(request.color.exposure_swing, arguments.exposure_swing);
  override_with(request.rolling_shutter_s, arguments.rolling_ms, 1e-3);
  override_with(request.depth.noise_per_m, arguments.depth_noise);
  override_with(request.depth.units_per_m, arguments.depth_units);
  override_with(request.dropped_fraction, arguments.dropped);
  return request;
}

int render(const SynthArguments& arguments) {
  const synth::SynthRequest request = request_of(arguments);
  install_interrupt_handlers();
  std::optional<ProgressLine> line;
  const synth::RenderControl control{.progress =
                                         [&](int done, int total) {
                                           if (!line)
                                             line.emplace("rendering " + request.preset,
                                                          static_cast<std::size_t>(total), "frames");
                                           line->update(static_cast<std::size_t>(done));
                                         },
                                     .stop_requested = interrupt_requested,
                                     .threads = arguments.threads};
  std::filesystem::path folder = arguments.out;
  if (arguments.out.empty()) {
    folder = synth::cached_sequence(request, control);
  } else if (!synth::render_sequence(request, folder, control)) {
    folder.clear();
  }
  line.reset();  // removes the progress line
  if (folder.empty()) {
    spdlog::warn("{}: the rendering was interrupted; {}", request.preset,
                 arguments.out.empty() ? "the cache keeps the rendered frames, and the same command continues"
                                       : "its output was removed");
    return kExitInterrupted;
  }
  std::cout << folder.string() << '\n';
  return kExitOk;
}

/// Camera, inertial sensor and rendering.
std::vector<Option> sensor_options_of(SynthArguments& arguments) {
  return {{"--width", "Image width [px]", &arguments.width, {1, 65535}},
          {"--height", "Image height [px]", &arguments.height, {1, 65535}},
          {"--focal", "Focal length [px]", &arguments.focal, {1, 1e6}},
          {"--rate", "Frame rate [Hz]", &arguments.rate, {0.1, 1000}},
          {"--exposure-ms", "Exposure time [ms]", &arguments.exposure_ms, {0, 1000}},
          {"--exposure-swing",
           "Amplitude of the slow exposure variation [stops]",
           &arguments.exposure_swing,
           {0, 10}},
          {"--rolling-shutter-ms",
           "Read-out time from the first to the last row [ms]",
           &arguments.rolling_ms,
           {0, 1000}},
          {"--depth-noise",
           "Standard deviation of depth noise per squared depth [1/m]",
           &arguments.depth_noise,
           {0, 1}},
          {"--depth-units",
           "Units of depth per meter: 1000 = mm, 5000 = as TUM RGB-D",
           &arguments.depth_units,
           {100, 60000}},
          {"--time-offset-ms", "Delay of the IMU time stamps [ms]", &arguments.time_offset_ms, {-1e6, 1e6}},
          {"--dropped", "Fraction of dropped frames", &arguments.dropped, {0, 1}},
          {"--threads",
           "Number of threads, 0 = all cores; does not affect the output",
           &arguments.threads,
           {0, 1000}}};
}

std::vector<Option> options_of(SynthArguments& arguments) {
  std::vector<Option> options = {
      {.name = "PRESET", .help = kPresets, .target = &arguments.preset, .may_be_omitted = true},
      {"--out", "Output folder [a folder in the cache]", &arguments.out},
      {"--seed", "Random seed; the output is a function of seed and options", &arguments.seed, {0, 1e9}},
      {"--seconds", "Duration [s]", &arguments.seconds, {0.01, 36000}},
      {"--people", "Number of walking people", &arguments.people, {0, 100}},
      {"--seated", "Number of seated people", &arguments.seated, {0, 100}},
      {"--unknown", "Number of moving carts and chairs without detections", &arguments.unknown, {0, 100}},
      {"--layout", "Output layout: " + enum_list<synth::SequenceLayout>(), &arguments.layout},
      {"--labels", "Also write instance masks", &arguments.labels},
      {"--trajectory",
       "Preset flight: IMU poses (TUM text); fr3, mesh: camera poses; home_tour, track: gt_SCENE_1.txt of "
       "OpenLORIS",
       &arguments.trajectory},
      {"--imu", "Preset flight: IMU samples (EuRoC CSV)", &arguments.imu},
      {"--track-sequence",
       "Preset track: number of the sequence in the file",
       &arguments.track_sequence,
       {0, 1000}},
      {"--mesh", "Scanned scene (PLY or OBJ with colors, meters, z up) instead of that of a preset",
       &arguments.mesh},
      {"--rig",
       "Calibration and noise of the sensors: rig.toml, or YAML of other programs; its time offset and "
       "read-out time are rendered, but not written",
       &arguments.rig},
      {"--times", "Recorded frame times, one per line [s]; a third field is the time of the depth image",
       &arguments.times},
      {"--start",
       "Preset flight, fr3, mesh, track or home_tour: offset of the first frame [s]",
       &arguments.start,
       {0, 1e6}}};
  std::ranges::move(sensor_options_of(arguments), std::back_inserter(options));
  return options;
}

}  // namespace

Command synth_command() {
  const auto arguments = std::make_shared<SynthArguments>();
  return {.name = "synth",
          .summary = "Render a sequence with exact ground truth",
          .example = "data synth walking_xyz --out build/walking_xyz --seed 1 --seconds 10 --people 2",
          .options = options_of(*arguments),
          .action = [arguments] { return render(*arguments); }};
}

}  // namespace stillpoint::bench
