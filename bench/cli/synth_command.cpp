// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/cli/progress.h"
#include "core/base/error.h"
#include "datasets/synthetic/sequence_cache.h"

namespace stillpoint {
namespace {

constexpr double kPresetValue = -1.0;  // an option that was not given

/// What the command line of `data synth` says.
struct SynthArguments {
  std::string preset;
  std::string out;
  std::string layout = "openloris";
  std::string trajectory, imu;
  bool labels = false;
  int seed = 1;
  int threads = 0;
  int people = -1, seated = -1, unknown = -1;
  int width = -1, height = -1;
  double seconds = kPresetValue, rate = kPresetValue, focal = kPresetValue;
  double exposure_ms = kPresetValue, exposure_swing = kPresetValue, rolling_ms = kPresetValue;
  double start = kPresetValue;
  double depth_noise = kPresetValue, time_offset_ms = 0.0, dropped = kPresetValue;
};

template <class Value, class Given>
void take(Value& value, Given given, double factor = 1.0) {
  if (given >= 0) value = static_cast<Value>(given * factor);
}

SynthRequest request_of(const SynthArguments& arguments) {
  SynthRequest request = preset_request(arguments.preset);
  if (arguments.layout != "openloris" && arguments.layout != "tum") {
    throw InputError("--layout", "\"" + arguments.layout + "\" is not known; use openloris or tum");
  }
  request.layout = arguments.layout == "tum" ? SequenceLayout::kTum : SequenceLayout::kOpenLoris;
  request.labels = arguments.labels;
  request.trajectory_file = arguments.trajectory;
  request.imu_file = arguments.imu;
  request.imu.time_offset_s = 1e-3 * arguments.time_offset_ms;
  take(request.seed, arguments.seed);
  take(request.seconds, arguments.seconds);
  take(request.start_s, arguments.start);
  take(request.frames_per_s, arguments.rate);
  take(request.walkers, arguments.people);
  take(request.seated, arguments.seated);
  take(request.unknown_movers, arguments.unknown);
  take(request.focal_px, arguments.width, request.focal_px / request.width);  // keeps the field of view
  take(request.width, arguments.width);
  take(request.height, arguments.height);
  take(request.focal_px, arguments.focal);
  take(request.color.exposure_s, arguments.exposure_ms, 1e-3);
  take(request.color.exposure_swing, arguments.exposure_swing);
  take(request.rolling_shutter_s, arguments.rolling_ms, 1e-3);
  take(request.depth.noise_per_m, arguments.depth_noise);
  take(request.dropped_share, arguments.dropped);
  return request;
}

int synth(const SynthArguments& arguments) {
  const SynthRequest request = request_of(arguments);
  watch_interrupts();
  const auto frames = static_cast<std::size_t>(request.seconds * request.frames_per_s);
  ProgressLine line("rendering " + request.preset, frames, "frames");
  const RenderControl control{.progress = [&](int done, int) { line.update(static_cast<std::size_t>(done)); },
                              .stop_requested = interrupt_requested,
                              .threads = arguments.threads};
  std::filesystem::path folder = arguments.out;
  if (arguments.out.empty()) {
    folder = cached_sequence(request, control);
  } else if (!render_sequence(request, folder, control)) {
    folder.clear();
  }
  if (folder.empty()) throw InputError(request.preset, "the rendering was interrupted; nothing was kept");
  std::cout << folder.string() << '\n';
  return kExitOk;
}

std::vector<Option> options_of(SynthArguments& arguments) {
  return {{"PRESET", "walking_{xyz,static,rpy,halfsphere}, market, corridor, each also with _empty; flight",
           &arguments.preset},
          {"--out", "Folder to make; without it the sequence goes into the cache", &arguments.out},
          {"--seed", "Same seed, same bits", &arguments.seed},
          {"--seconds", "Length", &arguments.seconds},
          {"--people", "People who walk", &arguments.people},
          {"--seated", "People who sit", &arguments.seated},
          {"--unknown", "Carts and chairs that no detector knows", &arguments.unknown},
          {"--layout", "openloris or tum", &arguments.layout},
          {"--labels", "Also write instance numbers of every pixel", &arguments.labels},
          {"--trajectory", "flight: poses of the IMU (TUM text)", &arguments.trajectory},
          {"--imu", "flight: its readings (EuRoC csv)", &arguments.imu},
          {"--start", "flight: begin this long after its start [s]", &arguments.start},
          {"--width", "Picture width [px]", &arguments.width},
          {"--height", "Picture height [px]", &arguments.height},
          {"--focal", "Focal length [px]", &arguments.focal},
          {"--rate", "Frames per second", &arguments.rate},
          {"--exposure-ms", "Time the shutter is open", &arguments.exposure_ms},
          {"--exposure-swing", "Slow change of brightness [stops]", &arguments.exposure_swing},
          {"--rolling-shutter-ms", "Read-out time from the first to the last row", &arguments.rolling_ms},
          {"--depth-noise", "Depth noise at 1 m; grows with the square [1/m]", &arguments.depth_noise},
          {"--time-offset-ms", "IMU stamps are this much late", &arguments.time_offset_ms},
          {"--dropped", "Share of the frames that are lost", &arguments.dropped},
          {"--threads", "0 = all cores; the result is the same", &arguments.threads}};
}

}  // namespace

Command synth_command() {
  const auto arguments = std::make_shared<SynthArguments>();
  return {.name = "synth",
          .summary = "Render a sequence with exact ground truth",
          .example = "data synth walking_xyz --out build/walking_xyz --seed 1 --seconds 10 --people 2",
          .options = options_of(*arguments),
          .action = [arguments] { return synth(*arguments); },
          .subcommands = {}};
}

}  // namespace stillpoint
