// SPDX-License-Identifier: BSD-3-Clause
// nees_program [--runs N] [--seconds S] [--draw KEY=VALUE]... [KEY=VALUE of the config]...
// Prints the ratio of the NEES to its dimension, over the runs and five times of a simulation.
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "bench/config/config_file.h"
#include "tests/support/simulated/nees_simulation.h"

namespace stillpoint {
namespace {

struct Options {
  int runs = 50;
  double seconds = 30.0;
  NeesDraw draw;
  bench::ConfigRequest config;
};

void set_draw(const std::string& key, double value, NeesDraw& draw) {
  const std::map<std::string, double*> members = {
      {"pixel_noise_px", &draw.pixel_noise_px}, {"depth_noise", &draw.depth_noise},
      {"track_length_s", &draw.track_length_s}, {"time_offset_s", &draw.time_offset_s},
      {"extrinsics_m", &draw.extrinsics_m},     {"extrinsics_rad", &draw.extrinsics_rad},
      {"depth_factor", &draw.depth_factor}};
  *members.at(key) = value;
}

Options parse(int count, char** arguments) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    if (argument == "--runs") {
      options.runs = std::stoi(arguments[++i]);
    } else if (argument == "--seconds") {
      options.seconds = std::stod(arguments[++i]);
    } else if (argument == "--draw") {
      const std::string assignment = arguments[++i];
      const std::size_t equals = assignment.find('=');
      set_draw(assignment.substr(0, equals), std::stod(assignment.substr(equals + 1)), options.draw);
    } else {
      options.config.settings.push_back(argument);
    }
  }
  return options;
}

/// Sums over runs, at each checkpoint.
struct Row {
  int dimension = 0;
  std::vector<double> squared, error;
  std::vector<int> count;
};

void print_row(const std::string& quantity, const Row& row) {
  double squared = 0.0, error = 0.0;
  int count = 0;
  std::printf("%-19s", quantity.c_str());
  for (std::size_t i = 0; i < row.count.size(); ++i) {
    std::printf(" %6.2f", row.squared[i] / row.dimension / std::max(row.count[i], 1));
    squared += row.squared[i];
    error += row.error[i];
    count += row.count[i];
  }
  // Checkpoints of one run are correlated: the interval is that of one independent value per run.
  const double degrees = static_cast<double>(row.dimension) * row.count.back();
  const double ratio = squared / row.dimension / count;
  const double half_width = 1.96 * std::sqrt(2.0 / degrees);
  std::printf("  %6.3f [%.2f, %.2f]  %.3g\n", ratio, ratio * (1.0 - half_width), ratio * (1.0 + half_width),
              std::sqrt(error / count));
}

int run(int count, char** arguments) {
  Options options = parse(count, arguments);
  const OdometryConfig config = bench::load_config(options.config);
  std::vector<double> checkpoints;
  for (int i = 0; i < 5; ++i) checkpoints.push_back(3.0 + i * (options.seconds - 3.0) / 4.0);
  std::map<std::string, Row> rows;
  int lost = 0;
  for (int i = 0; i < options.runs; ++i) {
    options.draw.seed = static_cast<std::uint32_t>(i + 1);
    const auto result = simulate_nees(config, options.draw, checkpoints);
    for (std::size_t k = 0; k < result.size(); ++k) {
      lost += result[k].empty();
      for (const NeesTerm& term : result[k]) {
        Row& row = rows[term.quantity];
        row.dimension = term.dimension;
        for (auto* values : {&row.squared, &row.error}) values->resize(checkpoints.size());
        row.count.resize(checkpoints.size());
        row.squared[k] += term.squared;
        row.error[k] += term.error * term.error;
        ++row.count[k];
      }
    }
    std::fprintf(stderr, "\r%d / %d", i + 1, options.runs);
  }
  std::printf("\n%-19s", "NEES / dimension");
  for (const double t : checkpoints) std::printf(" %5.1fs", t);
  std::printf("    mean  95 %% interval  RMSE\n");
  for (const auto& [quantity, row] : rows) print_row(quantity, row);
  std::printf("checkpoints without a state: %d\n", lost);
  return 0;
}

}  // namespace
}  // namespace stillpoint

int main(int count, char** arguments) {
  try {
    return stillpoint::run(count, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
