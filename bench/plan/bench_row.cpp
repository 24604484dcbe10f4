// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/bench_row.h"

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint {
namespace {

using Json = nlohmann::json;

std::optional<double> number(const Json& json, std::string_view key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

void read_timings(BenchRow& row, const Json& timings) {
  for (std::size_t i = 0; i < kModuleCount; ++i) {
    const std::string name(module_name(static_cast<Module>(i)));
    for (const char* group : {"modules", "threads"}) {
      const Json& table = timings.at(group);
      if (table.contains(name)) row.mean_ms[i] = number(table.at(name), "mean");
    }
  }
}

}  // namespace

BenchRow read_result(const std::filesystem::path& result_file, BenchRow row) {
  try {
    const Json json = Json::parse(read_text_file(result_file));
    row.status = json.at("status").get<std::string>();
    if (json.at("failure").is_string()) row.reason = json.at("failure").get<std::string>();
    row.ate_rmse_m = number(json, "ate_rmse_m");
    row.rpe_trans_rmse_m_per_s = number(json, "rpe_trans_rmse_m_per_s");
    row.rpe_rot_rmse_deg_per_s = number(json, "rpe_rot_rmse_deg_per_s");
    row.correct_rate = number(json, "correct_rate");
    row.coverage = number(json, "coverage");
    row.first_pose_s = number(json, "first_pose_s");
    read_timings(row, json.at("timings"));
    return row;
  } catch (const Json::exception& error) {
    throw InputError(result_file.string(), std::string("is no result file: ") + error.what());
  }
}

}  // namespace stillpoint
