// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/config_hash.h"

#include "bench/config/config_file.h"
#include "bench/model/stored_run.h"
#include "core/base/content_hash.h"

namespace stillpoint::bench {

std::string config_hash(const OdometryConfig& config) {
  std::string text;
  for (const auto& [key, value] : config_entries(config)) {
    if (key != kPerturbationKey) text.append(key).append(" = ").append(value).append("\n");
  }
  return perturbed_hash(hash_text(content_hash(text)), config.pipeline.perturbation_seed);
}

}  // namespace stillpoint::bench
