// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/score_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace stillpoint::bench {
namespace {

using Json = nlohmann::ordered_json;

/// The metrics of a score, in display order.
struct MetricField {
  const char* key;
  const char* title;
  const char* unit;
  std::optional<double> eval::Score::*value;
};
constexpr MetricField kNumbers[] = {
    {"coverage", "coverage", "", &eval::Score::coverage},
    {"ate_rmse_m", "ATE rmse", "m", &eval::Score::ate_rmse_m},
    {"rpe_trans_rmse_m_per_s", "T.RPE rmse", "m/s", &eval::Score::rpe_trans_rmse_m_per_s},
    {"rpe_rot_rmse_deg_per_s", "R.RPE rmse", "deg/s", &eval::Score::rpe_rot_rmse_deg_per_s},
    {"correct_rate", "correct rate", "", &eval::Score::correct_rate},
    {"first_pose_s", "first pose", "s", &eval::Score::first_pose_s}};

}  // namespace

Json score_members(const eval::Score& score) {
  Json json;
  for (const MetricField& number : kNumbers) {
    const std::optional<double>& value = score.*number.value;
    json[number.key] = value ? Json(*value) : Json(nullptr);
  }
  json["ate_pairs"] = score.ate_pairs;
  json["rpe_pairs"] = score.rpe_pairs;
  json["protocols"] = {{"ate", "compat:tum, 0.02 s, one-to-one, rigid alignment"},
                       {"rpe", "compat:tum, fixed delta of 1 s, all pairs"},
                       {"correct_rate", "openloris, 1 m, 30 deg, over the time of the ground truth"},
                       {"coverage", "fraction of frames with a pose"}};
  return json;
}

std::string score_text(const eval::Score& score) {
  std::string text;
  for (const MetricField& number : kNumbers) {
    const std::optional<double>& value = score.*number.value;
    text += fmt::format("{:<13} {}\n", number.title,
                        value ? fmt::format("{:.6f} {}", *value, number.unit) : "n/a");
  }
  return text;
}

std::string score_json(const eval::Score& score) { return score_members(score).dump(2) + "\n"; }

}  // namespace stillpoint::bench
