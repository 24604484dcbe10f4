// SPDX-License-Identifier: BSD-3-Clause
/// Synthetic histories with known changes.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "bench/analysis/commit_history.h"

namespace stillpoint::bench {

/// A history of as many commits as the longest series has values; commit i is named "c<i>".
inline CommitHistory history_of(const std::string& metric,
                                const std::vector<std::vector<double>>& all_values) {
  CommitHistory history;
  for (const std::vector<double>& values : all_values) {
    HistorySeries series;
    series.subject.sequence = std::string("s").append(std::to_string(history.series.size()));
    series.subject.variant = "vo";
    series.metric = metric;
    series.gated = gated_metric(metric);
    for (std::size_t i = 0; i < values.size(); ++i) {
      series.commits.push_back(i);
      if (i == history.commits.size())
        history.commits.push_back({std::string("c").append(std::to_string(i)), ""});
    }
    series.values = values;
    series.runs.assign(values.size(), 1);
    history.series.push_back(series);
  }
  return history;
}

/// Appends `count` values of a level with relative noise, normal or (`heavy`) Student's t with 3 degrees of
/// freedom.
inline void append_level(std::vector<double>& values, std::size_t count, double level, double noise,
                         std::mt19937_64& random, bool heavy = false) {
  std::normal_distribution<double> normal;
  std::student_t_distribution<double> student(3.0);
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(level * (1.0 + noise * (heavy ? student(random) : normal(random))));
}

}  // namespace stillpoint::bench
