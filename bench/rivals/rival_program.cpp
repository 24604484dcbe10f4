// SPDX-License-Identifier: BSD-3-Clause
#include "bench/rivals/rival_program.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>

#include <fmt/format.h>

#include "datasets/open_sequence.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::rivals {
namespace {

namespace fs = std::filesystem;

/// The document that `timings` of a description names.
std::string timings_json(std::vector<double> ms) {
  if (ms.empty()) return "{\"modules\": {}, \"threads\": {}}\n";
  double sum = 0.0;
  for (const double time : ms) sum += time;
  std::ranges::sort(ms);
  const auto at = [&](double fraction) {
    return ms[static_cast<std::size_t>(fraction * static_cast<double>(ms.size() - 1))];
  };
  return fmt::format(
      "{{\"modules\": {{}}, \"threads\": {{\"tracking_thread\": {{\"mean\": {:.6f}, \"median\": {:.6f}, "
      "\"p95\": {:.6f}, \"max\": {:.6f}, \"calls\": {}}}}}}}\n",
      sum / static_cast<double>(ms.size()), at(0.5), at(0.95), ms.back(), ms.size());
}

void run(const fs::path& sequence, const fs::path& out, const std::vector<std::string>& arguments,
         const TrackerMaker& make) {
  const auto stream = datasets::open_sequence(sequence);
  const Tracker track = make(stream->info().rig, arguments);
  Trajectory trajectory{.frame = "camera", .poses = {}};
  std::vector<double> times_ms;
  for (std::size_t i = 0; i < stream->info().frame_times.size(); ++i) {
    const Frame frame = stream->load_frame(i);
    const auto start = std::chrono::steady_clock::now();
    const std::optional<Pose> T_w_c = track(frame);
    times_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    if (T_w_c) trajectory.poses.push_back({frame.t, *T_w_c});
  }
  eval::write_tum(trajectory, out / "trajectory.tum");
  eval::write_text_file(out / "timings.json", timings_json(std::move(times_ms)));
}

}  // namespace

int run_rival(int argc, char** argv, const TrackerMaker& make) {
  try {
    if (argc < 3) {
      std::fprintf(stderr, "usage: %s SEQUENCE OUT [arguments]\n", argv[0]);
      return 1;
    }
    run(argv[1], argv[2], std::vector<std::string>(argv + 3, argv + argc), make);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: error: %s\n", argv[0], error.what());
    return 1;
  }
}

}  // namespace stillpoint::rivals
