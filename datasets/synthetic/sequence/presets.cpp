// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/presets.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/synthetic/scenes/mesh_file.h"
#include "datasets/synthetic/sequence/recorded_motion.h"

namespace stillpoint::synth {
namespace {

const std::vector<std::string> kBasePresets{"walking_xyz",        "walking_static", "walking_rpy",
                                            "walking_halfsphere", "market",         "corridor"};
const std::string kEmptySuffix = "_empty";
const std::string kShortSuffix = "_short";
const std::string kHomeTour = "home_tour";
const std::string kTrack = "track";
const std::string kFr3 = "fr3";
const std::string kMesh = "mesh";

/// A sequence of TUM RGB-D, and the people in it.
struct Fr3Preset {
  std::string name;
  int walkers, seated, unknown_movers;
};
const std::vector<Fr3Preset> kFr3Presets{{"fr3_walking_xyz", 2, 1, 1},
                                         {"fr3_walking_static", 2, 1, 1},
                                         {"fr3_walking_rpy", 2, 1, 1},
                                         {"fr3_walking_halfsphere", 2, 1, 1},
                                         {"fr3_sitting_static", 0, 2, 0}};

/// A preset that returns to places, and its variation with the suffix `_short`. Durations follow from the
/// lengths of the routes; `loop_presets_test` verifies them.
struct LoopPreset {
  std::string name;
  double seconds, short_seconds;  ///< 0: no short variation
  int walkers, seated, unknown_movers;
};
const std::vector<LoopPreset> kLoopPresets{
    {"office_laps", 90.0, 36.0, 3, 2, 1},  {"corridor_laps", 110.0, 92.0, 2, 0, 0},
    {"market_laps", 182.0, 70.0, 9, 0, 2}, {"twin_aisles", 100.0, 32.0, 2, 0, 1},
    {"changed_room", 75.0, 60.0, 2, 0, 0}, {kHomeTour, 236.0, 0.0, 2, 0, 0}};

void require(bool condition, const std::string& field, const std::string& range) {
  if (!condition) throw InputError("synth: " + field, "is out of range; use " + range);
}

void use_robot_camera(SynthRequest& request) {  // D435i as in the OpenLORIS packages
  request.width = 848;
  request.height = 480;
  request.focal_px = 611.0;
  request.seconds = 30.0;
}

/// A D435i with a quarter of the pixels: these sequences are long, and a frame of 848x480 takes 1 MB on disk.
void use_loop_preset(SynthRequest& request) {
  for (const LoopPreset& preset : kLoopPresets) {
    if (!is_preset(request, preset.name)) continue;
    request.width = 424;
    request.height = 240;
    request.focal_px = 305.5;
    request.seconds = is_short(request) ? preset.short_seconds : preset.seconds;
    request.walkers = preset.walkers;
    request.seated = preset.seated;
    request.unknown_movers = preset.unknown_movers;
  }
  if (request.preset != kHomeTour) return;
  request.frames_per_s = 15.0;  // 0.3 m/s on average
  request.start_s = 1.0;
  request.trajectory_file = recording_file("openloris/groundtruth/gt_home_1.txt");
}

/// Frames from the first one on that the trajectory covers.
void use_hand_recording(SynthRequest& request) {
  request.start_s = kRecordingMargin_s;
  for (const Fr3Preset& preset : kFr3Presets) {
    if (request.preset != preset.name) continue;
    request.trajectory_file = recording_file("tum_fr3_groundtruth/" + preset.name + "_groundtruth.txt");
    request.times_file = recording_file("tum_fr3_times/" + preset.name + ".txt");
    request.walkers = preset.walkers;
    request.seated = preset.seated;
    request.unknown_movers = preset.unknown_movers;
  }
}

void check_hand_recording(const SynthRequest& request) {
  if (!is_hand_recording(request)) return;
  if (request.trajectory_file.empty()) {
    throw InputError("preset \"fr3\"",
                     "needs the ground truth of a sequence of TUM RGB-D; pass --trajectory FILE");
  }
  for (const std::filesystem::path& file : {request.trajectory_file, request.times_file}) {
    if (file.empty() || std::filesystem::exists(file)) continue;
    throw InputError(
        "preset \"" + request.preset + "\"",
        "needs " + file.string() +
            ", which does not exist; set STILLPOINT_DATA to the folder of tum_fr3_groundtruth and "
            "tum_fr3_times, or pass --trajectory FILE --times FILE");
  }
}

void check_files(const SynthRequest& request) {
  const bool files = !request.trajectory_file.empty() && !request.imu_file.empty();
  if (request.preset == "flight" && !files) {
    throw InputError("preset \"flight\"",
                     "needs a trajectory and its IMU samples; pass --trajectory FILE --imu FILE");
  }
  if (request.preset == kHomeTour && !std::filesystem::exists(request.trajectory_file)) {
    throw InputError("preset \"home_tour\"",
                     "needs the ground truth of OpenLORIS home, but " + request.trajectory_file.string() +
                         " does not exist; set STILLPOINT_DATA to the folder of "
                         "openloris/groundtruth/gt_home_1.txt, or pass --trajectory FILE");
  }
  if (request.preset == kTrack && (request.trajectory_file.empty() || request.track_sequence < 1)) {
    throw InputError(
        "preset \"track\"",
        "needs a ground truth of OpenLORIS and the number of a sequence in it; pass --trajectory "
        "FILE --track-sequence N");
  }
  if (is_mesh(request) && (request.mesh_file.empty() || request.trajectory_file.empty())) {
    throw InputError("preset \"mesh\"",
                     "needs a mesh and the path of the camera in it; pass --mesh FILE --trajectory FILE");
  }
  if (!is_mesh(request) && !request.mesh_file.empty()) {
    throw InputError("preset \"" + request.preset + "\"", "has a scene of its own; remove it, or --mesh");
  }
  check_hand_recording(request);
  if (request.preset == "flight" && !request.rig_file.empty()) {
    throw InputError("preset \"flight\"", "has the rig of its recording; remove --rig");
  }
  if (request.preset == "flight" && !request.times_file.empty()) {
    throw InputError("preset \"flight\"", "has the times of its recording; remove --times");
  }
}

}  // namespace

bool is_short(const SynthRequest& request) { return request.preset.ends_with(kShortSuffix); }

bool is_preset(const SynthRequest& request, const std::string& name) {
  return request.preset == name || request.preset == name + kShortSuffix;
}

bool is_hand_recording(const SynthRequest& request) { return request.preset.starts_with(kFr3); }

bool is_mesh(const SynthRequest& request) { return request.preset == kMesh; }

bool is_loop_preset(const SynthRequest& request) {
  return std::any_of(kLoopPresets.begin(), kLoopPresets.end(),
                     [&](const LoopPreset& preset) { return is_preset(request, preset.name); });
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names = kBasePresets;
  for (const std::string& preset : kBasePresets) names.push_back(preset + kEmptySuffix);
  names.push_back("flight");
  names.push_back(kTrack);
  names.push_back(kMesh);
  names.push_back(kFr3);
  for (const Fr3Preset& preset : kFr3Presets) names.push_back(preset.name);
  for (const LoopPreset& preset : kLoopPresets) {
    names.push_back(preset.name);
    if (preset.short_seconds > 0.0) names.push_back(preset.name + kShortSuffix);
  }
  return names;
}

SynthRequest preset_request(const std::string& name) {
  const std::vector<std::string> names = preset_names();
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    std::string list;
    for (const std::string& valid : names) list += (list.empty() ? "" : ", ") + valid;
    throw InputError("preset \"" + name + "\"", "is unknown; expected one of: " + list);
  }
  SynthRequest request;
  request.preset = name;
  use_loop_preset(request);
  if (is_hand_recording(request) || is_mesh(request)) use_hand_recording(request);
  if (is_loop_preset(request) || is_hand_recording(request) || is_mesh(request)) return request;
  if (name.starts_with("market") || name.starts_with("corridor")) use_robot_camera(request);
  if (name == kTrack) use_robot_camera(request);
  if (name == "flight") request.seconds = 25.0;
  if (name == "flight" || name == kTrack || name.ends_with(kEmptySuffix)) return request;
  const bool market = name == "market";
  request.walkers = market ? 9 : 2;
  request.seated = name.starts_with("walking") ? 1 : 0;
  request.unknown_movers = market ? 2 : 1;
  return request;
}

void check_request(const SynthRequest& request) {
  require(request.seconds > 0.0 && request.seconds <= 3600.0, "seconds", "0 to 3600");
  require(request.frames_per_s >= 1.0 && request.frames_per_s <= 200.0, "frames_per_s", "1 to 200");
  require(request.width >= 16 && request.width <= 4096, "width", "16 to 4096");
  require(request.height >= 16 && request.height <= 4096, "height", "16 to 4096");
  require(request.focal_px > 0.1 * request.width, "focal_px", "more than a tenth of the width");
  require(request.walkers >= 0 && request.walkers <= 40, "walkers", "0 to 40");
  require(request.seated >= 0 && request.seated <= 8, "seated", "0 to 8");
  require(request.unknown_movers >= 0 && request.unknown_movers <= 20, "unknown_movers", "0 to 20");
  require(request.dropped_fraction >= 0.0 && request.dropped_fraction <= 0.5, "dropped_share", "0 to 0.5");
  require(request.color.exposure_s >= 0.0 && request.color.exposure_s * request.frames_per_s <= 1.0,
          "color.exposure_s", "0 to the time between two frames");
  require(request.rolling_shutter_s >= 0.0 && request.rolling_shutter_s * request.frames_per_s <= 1.0,
          "rolling_shutter_s", "0 to the time between two frames");
  require(request.depth.noise_per_m >= 0.0 && request.depth.min_m < request.depth.max_m, "depth",
          "noise_per_m >= 0 and min_m < max_m");
  if (request.layout == SequenceLayout::kOpenLoris && request.depth.units_per_m != 1000.0) {
    throw InputError("synth: depth.units_per_m",
                     "is not 1000, but the layout openloris has depth in millimeters; "
                     "use the layout tum or --depth-units 1000");
  }
  require(request.depth.correlation_px >= 1, "depth.correlation_px", "1 or more");
  require(request.detector.miss_rate >= 0.0 && request.detector.miss_rate <= 0.9, "detector.miss_share",
          "0 to 0.9");
  require(request.detector.burst_frames >= 1.0, "detector.burst_frames", "1 or more");
  require(request.imu.gyro_rate_hz >= 10.0 && request.imu.accel_rate_hz >= 10.0, "imu rates",
          "10 Hz or more");
  require(request.start_s >= 0.0, "start_s", "0 or more");
  check_files(request);
}

namespace {

/// Collects `name = value` lines; descends into nested structs with their `visit_fields`.
class TextCollector {
 public:
  void operator()(const std::string& name, bool value) { add(name, value ? "true" : "false"); }
  void operator()(const std::string& name, int value) { add(name, fmt::format("{}", value)); }
  void operator()(const std::string& name, std::uint64_t value) { add(name, fmt::format("{}", value)); }
  void operator()(const std::string& name, double value) { add(name, fmt::format("{:.17g}", value)); }
  void operator()(const std::string& name, const std::string& value) {
    add(name, fmt::format("\"{}\"", value));
  }
  void operator()(const std::string& name, SequenceLayout value) {
    for (const auto& [layout, spelling] : enum_names(SequenceLayout{})) {
      if (layout == value) add(name, fmt::format("\"{}\"", spelling));
    }
  }
  template <class Group>
  void operator()(const std::string& name, const Group& group) {
    const std::string outer = prefix_;
    prefix_ += name + ".";
    visit_fields(*this, group);
    prefix_ = outer;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void add(const std::string& name, const std::string& value) {
    text_ += prefix_ + name + " = " + value + "\n";
  }
  std::string prefix_;
  std::string text_;
};

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw InputError(file.string(),
                     "cannot be read; correct the path, or set STILLPOINT_DATA (presets home_tour, fr3_*)");
  return {std::istreambuf_iterator<char>(in), {}};
}

std::uint64_t fnv1a(const std::string& text, std::uint64_t hash) {
  for (const char character : text) {
    hash = (hash ^ static_cast<std::uint8_t>(character)) * 0x100000001b3ULL;
  }
  return hash;
}

}  // namespace

std::string request_text(const SynthRequest& request) {
  TextCollector collector;
  visit_fields(collector, request);
  return fmt::format("renderer_version = {}\n", kRendererVersion) + collector.text();
}

std::string request_key(const SynthRequest& request) {
  SynthRequest nameless = request;  // the key depends on the contents of the files, not on their paths
  nameless.trajectory_file.clear();
  nameless.imu_file.clear();
  nameless.times_file.clear();
  nameless.mesh_file.clear();
  nameless.rig_file.clear();
  std::uint64_t hash = fnv1a(request_text(nameless), 0xcbf29ce484222325ULL);
  std::vector<std::filesystem::path> files{request.trajectory_file, request.imu_file, request.times_file,
                                           request.mesh_file, request.rig_file};
  if (!request.mesh_file.empty())
    std::ranges::move(companions_of_mesh(request.mesh_file), std::back_inserter(files));
  for (const std::filesystem::path& file : files) {
    if (!file.empty()) hash = fnv1a(contents(file), hash);
  }
  return fmt::format("{:016x}", hash);
}

std::string sequence_id(const SynthRequest& request) { return "synth-" + request_key(request); }

}  // namespace stillpoint::synth
