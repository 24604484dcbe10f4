// SPDX-License-Identifier: BSD-3-Clause
// A fake SLAM system for benchmark tests: writes the ground truth of a TUM folder plus a simulated error, and
// simulated timings. It accepts the options of `stillpoint run` that benchmarks use, preceded by:
//   --error M          amplitude of the sinusoidal trajectory error [m]; default 0.01
//   --worse SEQ F      multiplies the error by F on the sequence of this name
//   --slow MODULE F    multiplies the time of a module by F
//   --noise SIGMA      relative standard deviation of the times, seeded by seed and repetition; default 0.02
//   --crash-after N    terminates by a signal after N poses
//   --hang             never terminates
//   --fill MB          allocates this amount of memory and never terminates
//   --pause MS         waits before it writes: a process that ends at once is not measured
//   --log FILE         appends a line on success
//   --unperturbed      rejects the config key pipeline.perturbation_seed, as an old version. Without it, the
//                      error of a perturbed run differs by about 1 %
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "eval/io/trajectory_file.h"
#include "eval/score.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string sequence;
  fs::path out = ".";
  std::string name;  ///< of the first --out: the key of the run, unless the program was given another one
  double error_m = 0.01;
  std::string worse_sequence, slow_module;
  double worse = 1.0, slow = 1.0, noise = 0.02;
  std::string seed = "1";
  int perturbation_seed = 0;
  bool unperturbed = false;
  bool shows_config = false;
  long crash_after = -1;
  bool hang = false;
  std::size_t fill_mb = 0;
  unsigned pause_ms = 0;
  std::string log;
};

constexpr std::string_view kPerturbation = "pipeline.perturbation_seed=";

Options parse(const std::vector<std::string>& words) {
  Options options;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    const auto next = [&] { return ++i < words.size() ? words[i] : std::string(); };
    if (word == "run") options.sequence = next();
    if (word == "--out") {
      options.out = next();
      if (options.name.empty()) options.name = options.out.filename().string();
    }
    if (word == "--error") options.error_m = std::stod(next());
    if (word == "--worse") {
      options.worse_sequence = next();
      options.worse = std::stod(next());
    }
    if (word == "--slow") {
      options.slow_module = next();
      options.slow = std::stod(next());
    }
    if (word == "--noise") options.noise = std::stod(next());
    if (word == "config") options.shows_config = true;
    if (word == "--unperturbed") options.unperturbed = true;
    if (word == "--set") {
      const std::string setting = next();
      const bool is_perturbation = setting.starts_with(kPerturbation);
      if (is_perturbation) options.perturbation_seed = std::stoi(setting.substr(kPerturbation.size()));
      if (!is_perturbation) options.seed = setting;
    }
    if (word == "--crash-after") options.crash_after = std::stol(next());
    if (word == "--hang") options.hang = true;
    if (word == "--fill") options.fill_mb = std::stoul(next());
    if (word == "--pause") options.pause_ms = static_cast<unsigned>(std::stoul(next()));
    if (word == "--log") options.log = next();
  }
  return options;
}

/// The true trajectory plus a sinusoidal error, which alignment cannot remove: the ATE is proportional to it.
Trajectory replay(const Trajectory& truth, const Options& options) {
  const bool is_worse = fs::path(options.sequence).filename() == options.worse_sequence;
  std::mt19937_64 random(static_cast<std::uint64_t>(options.perturbation_seed));
  const double perturbation =
      options.perturbation_seed == 0 ? 0.0 : std::normal_distribution<double>(0.0, 0.01)(random);
  const double amplitude = options.error_m * (is_worse ? options.worse : 1.0) * (1.0 + perturbation);
  Trajectory path = truth;
  for (std::size_t i = 0; i < path.poses.size(); ++i) {
    path.poses[i].T_w_f.p.z() += amplitude * std::sin(0.5 * static_cast<double>(i));
    if (options.crash_after == static_cast<long>(i)) std::raise(SIGSEGV);
  }
  return path;
}

/// Times of two modules [ms]; deterministic for a run, and with a name also independent of the configs of the
/// odometry, which the key of the run depends on.
std::string timings_text(const Options& options) {
  std::string text;
  std::mt19937_64 random(std::hash<std::string>{}(fmt::format("{} {} {} {}", options.seed, options.name,
                                                              fs::path(options.sequence).filename().string(),
                                                              options.perturbation_seed)));
  for (const char* module : {"feature_tracking", "state_optimization"}) {
    std::normal_distribution<double> spread(1.0, options.noise);
    const double ms = 10.0 * spread(random) * (options.slow_module == module ? options.slow : 1.0);
    text += fmt::format("{}\"{}\": {{\"mean\": {}, \"median\": {}, \"p95\": {}, \"max\": {}, \"calls\": 30}}",
                        text.empty() ? "" : ", ", module, ms, ms, ms, ms);
  }
  return text;
}

void write_result(const eval::Score& score, const Options& options) {
  const std::string ate_rmse_m = score.ate ? fmt::format("{}", score.ate->translation_m.rmse) : "null";
  std::ofstream(options.out / "manifest.json") << "{\"system\": \"replay\"}\n";
  std::ofstream(options.out / "result.json") << fmt::format(
      "{{\"status\": \"ok\", \"failure\": null, \"ate_rmse_m\": {}, \"coverage\": 1.0,\n"
      " \"timings\": {{\"modules\": {{{}}}, \"threads\": {{}}}}}}\n",
      ate_rmse_m, timings_text(options));
}

int run(const Options& options) {
  if (options.unperturbed && options.perturbation_seed != 0) return 2;
  if (options.shows_config) return 0;
  while (options.hang) pause();
  const std::vector<char> filled(options.fill_mb << 20, 'x');
  while (!filled.empty() && filled[filled.size() / 2] == 'x') pause();
  const Trajectory truth =
      eval::read_tum(fs::path(options.sequence) / "groundtruth.txt", "camera").trajectory;
  const Trajectory path = replay(truth, options);
  usleep(1000 * options.pause_ms);
  eval::write_tum(path, options.out / "trajectory.tum");
  write_result(eval::score(truth, path), options);
  if (!options.log.empty())
    std::ofstream(options.log, std::ios::app) << options.out.filename().string() + "\n";
  return 0;
}

}  // namespace
}  // namespace stillpoint

int main(int argc, char** argv) {
  return stillpoint::run(stillpoint::parse(std::vector<std::string>(argv + 1, argv + argc)));
}
