// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/stored_run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "core/base/content_hash.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

constexpr std::array<std::pair<Outcome, std::string_view>, 7> kNames = {
    {{Outcome::kOk, "ok"},
     {Outcome::kLost, "lost"},
     {Outcome::kInterrupted, "interrupted"},
     {Outcome::kCrashed, "crashed"},
     {Outcome::kTimedOut, "timed_out"},
     {Outcome::kOutOfMemory, "out_of_memory"},
     {Outcome::kBadData, "bad_data"}}};

constexpr std::string_view kLostStatus = "failed";
constexpr std::string_view kPerturbationMark = "-perturbed-";  // before the seed in a config hash

}  // namespace

std::string run_key(const RunIdentity& identity) {
  // Unit separators distinguish ("ab", "c") from ("a", "bc").
  return hash_text(content_hash(
      fmt::format("{}\x1f{}\x1f{}\x1f{}\x1f{}\x1f{}\x1f{}\x1f{}\x1f{}\x1f{}\x1f{}\x1f{}\x1f{}",
                  identity.system, identity.variant, identity.sequence, identity.sequence_id,
                  identity.config_hash, identity.build, identity.mode, identity.kind, identity.cores,
                  identity.seed, identity.repetition, identity.axis, identity.axis_value)));
}

std::string outcome_name(Outcome outcome) {
  const auto found =
      std::find_if(kNames.begin(), kNames.end(), [&](const auto& name) { return name.first == outcome; });
  STILLPOINT_CHECK(found != kNames.end());
  return std::string(found->second);
}

std::string status_name(Outcome outcome) {
  return outcome == Outcome::kLost ? std::string(kLostStatus) : outcome_name(outcome);
}

Outcome outcome_of(std::string_view name) {
  if (name == kLostStatus) return Outcome::kLost;
  const auto found =
      std::find_if(kNames.begin(), kNames.end(), [&](const auto& entry) { return entry.second == name; });
  if (found != kNames.end()) return found->first;
  throw InputError("outcome \"" + std::string(name) + "\"",
                   "is unknown; use ok, lost, interrupted, crashed, timed_out, out_of_memory or bad_data");
}

std::optional<double> metric_value(const StoredRun& run, std::string_view name) {
  for (const Metric& metric : run.metrics) {
    if (metric.name == name) return metric.value;
  }
  return std::nullopt;
}

std::string perturbed_hash(const std::string& hash, int seed) {
  return seed == 0 ? hash : hash + std::string(kPerturbationMark) + std::to_string(seed);
}

std::string_view unperturbed_hash(std::string_view config_hash) {
  return config_hash.substr(0, config_hash.find(kPerturbationMark));
}

bool is_perturbed(std::string_view config_hash) {
  return config_hash.find(kPerturbationMark) != std::string_view::npos;
}

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
}

}  // namespace stillpoint::bench
