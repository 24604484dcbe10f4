// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/replicates.h"

namespace stillpoint::bench {
namespace {

constexpr std::string_view kMark = "-perturbed-";

}  // namespace

std::string perturbed_hash(const std::string& hash, int seed) {
  return seed == 0 ? hash : hash + std::string(kMark) + std::to_string(seed);
}

std::string_view unperturbed_hash(std::string_view config_hash) {
  return config_hash.substr(0, config_hash.find(kMark));
}

bool is_perturbed(std::string_view config_hash) { return config_hash.find(kMark) != std::string_view::npos; }

}  // namespace stillpoint::bench
