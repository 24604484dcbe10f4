// SPDX-License-Identifier: BSD-3-Clause
// nees_program [--runs N] [--first-seed N] [--seconds S] [--draw KEY=VALUE]... [KEY=VALUE of the config]...
// Prints the ratio of the NEES to its dimension, over the runs and five times of a simulation. Runs with
// different seeds are independent.
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
  int first_seed = 1;
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
    } else if (argument == "--first-seed") {
      options.first_seed = std::stoi(arguments[++i]);
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
  std::map<int, double> run_ratio;  ///< sum over the checkpoints of the run with that seed
};

/// Half width of the 95 % interval of the mean ratio, from the spread of the means of the runs: independent,
/// while the checkpoints of one run are correlated.
double half_width(const Row& row) {
  const auto runs = static_cast<double>(row.run_ratio.size());
  double sum = 0.0, squares = 0.0;
  for (const auto& [seed, ratio] : row.run_ratio) {
    const double mean = ratio / static_cast<double>(row.count.size());
    sum += mean;
    squares += mean * mean;
  }
  const double variance = (squares - sum * sum / runs) / (runs - 1.0);
  return 1.96 * std::sqrt(variance / runs);
}

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
  const double ratio = squared / row.dimension / count;
  const double width = half_width(row);
  std::printf("  %6.3f [%.2f, %.2f]  %.3g\n", ratio, ratio - width, ratio + width, std::sqrt(error / count));
}

int run(int count, char** arguments) {
  Options options = parse(count, arguments);
  const OdometryConfig config = bench::load_config(options.config);
  std::vector<double> checkpoints;
  for (int i = 0; i < 5; ++i) checkpoints.push_back(3.0 + i * (options.seconds - 3.0) / 4.0);
  std::map<std::string, Row> rows;
  int lost = 0;
  for (int i = 0; i < options.runs; ++i) {
    options.draw.seed = static_cast<std::uint32_t>(options.first_seed + i);
    const auto result = simulate_nees(config, options.draw, checkpoints);
    for (std::size_t k = 0; k < result.size(); ++k) {
      lost += result[k].empty();
      for (const NeesTerm& term : result[k]) {
        Row& row = rows[term.quantity];
        row.dimension = term.dimension;
        for (auto* values : {&row.squared, &row.error}) values->resize(checkpoints.size());
        row.count.resize(checkpoints.size());
        row.squared[k] += term.squared;
        row.run_ratio[options.first_seed + i] += term.squared / term.dimension;
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
