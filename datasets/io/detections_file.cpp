// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/detections_file.h"

#include <fmt/format.h>

#include <string>

#include "eval/io/text_reader.h"

namespace stillpoint::datasets {
namespace {

constexpr std::size_t kNumbers = 5;  ///< score and four edges, after timestamp and class

Detection parse_detection(const eval::TextRow& row) {
  const std::size_t count = row.fields.size();
  if (count < kNumbers + 2) {
    throw row.error("expected `timestamp class score x_min y_min x_max y_max`, or only a timestamp");
  }
  const std::size_t score = count - kNumbers;
  Detection detection;
  for (std::size_t i = 1; i < score; ++i) {
    detection.class_name.append(i > 1 ? " " : "").append(row.fields[i]);
  }
  detection.score = row.finite_number(score);
  detection.box = Box{.x_min = row.finite_number(score + 1),
                      .y_min = row.finite_number(score + 2),
                      .x_max = row.finite_number(score + 3),
                      .y_max = row.finite_number(score + 4)};
  if (detection.score < 0.0 || detection.score > 1.0) throw row.error("the score is outside [0, 1]");
  if (detection.box.x_max <= detection.box.x_min || detection.box.y_max <= detection.box.y_min) {
    throw row.error("the box is empty or inverted; the order is x_min y_min x_max y_max");
  }
  return detection;
}

}  // namespace

std::vector<DetectionSet> read_detections(const std::filesystem::path& file, FaultLog& faults) {
  return parse_detections(eval::read_text_file(file), file.string(), faults);
}

std::vector<DetectionSet> parse_detections(const std::string& text, const std::string& name,
                                           FaultLog& faults) {
  std::vector<DetectionSet> sets;
  eval::for_each_row(text, name, faults, [&](const eval::TextRow& row) {
    const Timestamp t = row.time(0, eval::TimeUnit::kSeconds);
    const bool new_stamp = sets.empty() || t != sets.back().t;
    if (!sets.empty() && new_stamp) row.require_increasing(sets.back().t, t);
    DetectionSet set{.t = t, .state = DetectionState::kPresent, .detections = {}};
    if (row.fields.size() > 1) set.detections.push_back(parse_detection(row));
    if (new_stamp) {
      sets.push_back(std::move(set));
    } else {
      sets.back().detections.insert(sets.back().detections.end(), set.detections.begin(),
                                    set.detections.end());
    }
  });
  return sets;
}

std::string detections_header() {
  return "# timestamp class score x_min y_min x_max y_max; only a timestamp: no detections\n";
}

std::string detections_text(std::span<const DetectionSet> sets) {
  std::string text = detections_header();
  for (const DetectionSet& set : sets) {
    if (set.state != DetectionState::kPresent) continue;
    const std::string stamp = eval::format_stamp(set.t);
    if (set.detections.empty()) text += stamp + "\n";
    for (const Detection& found : set.detections) {
      text += fmt::format("{} {} {:.4f} {:.2f} {:.2f} {:.2f} {:.2f}\n", stamp, found.class_name, found.score,
                          found.box.x_min, found.box.y_min, found.box.x_max, found.box.y_max);
    }
  }
  return text;
}

}  // namespace stillpoint::datasets
