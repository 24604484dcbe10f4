// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/harness_profile.h"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace stillpoint::bench {
namespace {

using Json = nlohmann::ordered_json;

/// A line of the profile; `text` is its label, and `id` its name in JSON.
struct Part {
  const char* id;
  const char* text;
  double HarnessProfile::*seconds;
};
constexpr std::array<Part, 5> kWorkerParts = {
    {{"odometry_s", "odometry", &HarnessProfile::odometry_s},
     {"image_waits_s", "waiting for images", &HarnessProfile::image_waits_s},
     {"start_s", "start of processes", &HarnessProfile::start_s},
     {"output_s", "scores and files of runs", &HarnessProfile::output_s},
     {"other_process_s", "other processes", &HarnessProfile::other_process_s}}};
constexpr std::array<Part, 5> kOtherParts = {
    {{"decoding_s", "decoding threads", &HarnessProfile::decoding_s},
     {"rendering_s", "rendering", &HarnessProfile::rendering_s},
     {"preparing_s", "frame cache and warm-up", &HarnessProfile::preparing_s},
     {"scoring_s", "scoring", &HarnessProfile::scoring_s},
     {"storing_s", "storing", &HarnessProfile::storing_s}}};

double number(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? found->get<double>() : 0.0;
}

double seconds_of_calls(const RunOutcome& outcome, const std::string& module) {
  double sum_s = 0.0;
  for (const ModuleCost& cost : outcome.costs) {
    if (cost.module == module) sum_s += 1e-3 * cost.mean_ms * static_cast<double>(cost.calls);
  }
  return sum_s;
}

double worker_seconds(const HarnessProfile& profile) {
  return static_cast<double>(profile.workers) * profile.wall_s;
}

std::string profile_line(const HarnessProfile& profile, const char* text, double seconds) {
  const double all_s = worker_seconds(profile);
  return fmt::format("  {:<26}{:>9.2f} s  {:>5.1f} %\n", text, seconds,
                     all_s > 0.0 ? 100.0 * seconds / all_s : 0.0);
}

}  // namespace

double HarnessProfile::idle_s() const {
  double busy_s = 0.0;
  for (const Part& part : kWorkerParts) busy_s += this->*part.seconds;
  return std::max(0.0, worker_seconds(*this) - busy_s);
}

HarnessProfile with_run(HarnessProfile profile, const ProcessResult& process, const RunOutcome& outcome) {
  ++profile.runs;
  const auto text = outcome.attachments.find("result");
  const Json result = text == outcome.attachments.end()
                          ? Json()
                          : Json::parse(text->second, nullptr, /*allow_exceptions=*/false);
  if (!result.is_object() || !result.contains("start_s")) {
    profile.other_process_s += process.wall_s;
    return profile;
  }
  const double run_s = number(result, "wall_s");
  const double waits_s = std::min(run_s, number(result, "image_waits_s"));
  const double start_s = std::min(number(result, "start_s"), std::max(0.0, process.wall_s - run_s));
  profile.odometry_s += run_s - waits_s;
  profile.image_waits_s += waits_s;
  profile.start_s += start_s;
  profile.output_s += std::max(0.0, process.wall_s - run_s - start_s);
  profile.decoding_s += seconds_of_calls(outcome, "image_decoding");
  return profile;
}

std::string profile_text(const HarnessProfile& profile) {
  std::string text = fmt::format("{} runs, {} at once, {:.1f} s; time of the workers:\n", profile.runs,
                                 profile.workers, profile.wall_s);
  for (const Part& part : kWorkerParts) {
    if (profile.*part.seconds > 0.0) text += profile_line(profile, part.text, profile.*part.seconds);
  }
  text += profile_line(profile, "no run to execute", profile.idle_s());
  text += "outside of the workers:\n";
  for (const Part& part : kOtherParts) {
    if (profile.*part.seconds > 0.0) text += profile_line(profile, part.text, profile.*part.seconds);
  }
  return text;
}

std::string profile_json(const HarnessProfile& profile) {
  Json json = {{"runs", profile.runs}, {"workers", profile.workers}, {"wall_s", profile.wall_s}};
  for (const Part& part : kWorkerParts) json[part.id] = profile.*part.seconds;
  json["idle_s"] = profile.idle_s();
  for (const Part& part : kOtherParts) json[part.id] = profile.*part.seconds;
  return json.dump(2) + "\n";
}

}  // namespace stillpoint::bench
