// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/leveling_rotation.h"

#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "bench/model/json_problem.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {

std::optional<Eigen::Quaterniond> read_leveling_rotation(const std::filesystem::path& result_json) {
  constexpr const char* kMember = "leveling_rotation_xyzw";
  constexpr double kTolerance = 1e-6;  // of the norm
  try {
    const auto json = nlohmann::json::parse(eval::read_text_file(result_json));
    if (!json.contains(kMember)) return std::nullopt;
    const auto values = json.at(kMember).get<std::array<double, 4>>();
    const Eigen::Quaterniond q(values[3], values[0], values[1], values[2]);
    if (std::abs(q.norm() - 1.0) < kTolerance) return q.normalized();
  } catch (const nlohmann::json::exception& error) {
    throw InputError(result_json.string(), "is not a result file: " + json_problem(error));
  }
  throw InputError(result_json.string(), std::string(kMember) + " is no unit quaternion x, y, z, w");
}

}  // namespace stillpoint::bench
