// SPDX-License-Identifier: BSD-3-Clause
#include "bench/diagnose/diagnosis_text.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/base/counted.h"

namespace stillpoint::bench {
namespace {

constexpr std::size_t kMaxCauses = 4;

std::string effect_text(double ratio) { return fmt::format("{:+.0f} %", 100.0 * (ratio - 1.0)); }

std::string error_text(const Diagnosis& diagnosis, double error) {
  return diagnosis.measure == ErrorMeasure::kTruth ? fmt::format("{:.4f} m", error)
                                                   : fmt::format("{:.2f}", error);
}

std::string title(const Diagnosis& diagnosis) {
  const char* const measure = diagnosis.measure == ErrorMeasure::kTruth
                                  ? "error (ATE; frames without a pose count with the spread of the truth)"
                                  : "inconsistency (innovations of images and IMU; no ground truth)";
  std::string text = fmt::format("{}: {} ({:.1f} s), {}: {}", diagnosis.sequence,
                                 counted(static_cast<std::size_t>(diagnosis.frames), "frame"),
                                 diagnosis.seconds, measure, error_text(diagnosis, diagnosis.error));
  if (diagnosis.corrected != diagnosis.error)
    text += fmt::format(", corrected {}", error_text(diagnosis, diagnosis.corrected));
  return text + fmt::format("; {}{}\n", diagnosis.finished_run ? "the given run and " : "",
                            counted(static_cast<std::size_t>(diagnosis.trials), "trial"));
}

/// A line of the others that are refuted or not, with their effects; a large one that did not count is not
/// told from chance. Empty without any.
std::string line_of_others(const Diagnosis& diagnosis, const char* heading, bool refuted) {
  const double effective = 1.0 - diagnosis.least_effect;
  std::vector<std::string> parts;
  for (const Cause& cause : diagnosis.others) {
    if (cause.is_refuted(effective) != refuted) continue;
    const bool is_large = cause.error_ratio && *cause.error_ratio <= effective;
    parts.push_back(fmt::format("{} ({}{})", cause.name,
                                cause.error_ratio ? effect_text(*cause.error_ratio) : "not measured",
                                is_large ? ", within chance" : ""));
  }
  return parts.empty() ? "" : fmt::format("{}: {}\n", heading, fmt::join(parts, ", "));
}

nlohmann::ordered_json list(const std::vector<Cause>& causes) {
  nlohmann::ordered_json entries = nlohmann::ordered_json::array();
  for (const Cause& cause : causes) {
    entries.push_back({{"id", cause.id},
                       {"name", cause.name},
                       {"evidence", cause.evidence},
                       {"remedy", cause.remedy},
                       {"strength", cause.strength}});
    entries.back()["error_ratio"] = cause.error_ratio ? nlohmann::ordered_json(*cause.error_ratio) : nullptr;
  }
  return entries;
}

/// Of a run of another system, with evidence and remedy: the effects are measured with this odometry.
std::string others_text(const Diagnosis& diagnosis) {
  if (!diagnosis.foreign || !has_unmeasured(diagnosis)) {
    return line_of_others(diagnosis, "found, with less effect", false) +
           line_of_others(diagnosis, "not a cause, the error is larger without it", true);
  }
  std::string text = "found; the effect needs a run of this odometry (leave RUN out):\n";
  std::size_t number = 0;
  for (const Cause& cause : diagnosis.others) {
    if (cause.error_ratio || ++number > kMaxCauses) continue;
    text += fmt::format("- {}: {}\n  remedy: {}\n", cause.name, cause.evidence, cause.remedy);
  }
  return text;
}

}  // namespace

bool has_unmeasured(const Diagnosis& diagnosis) {
  return std::ranges::any_of(diagnosis.others, [](const Cause& cause) { return !cause.error_ratio; });
}

std::string diagnosis_text(const Diagnosis& diagnosis) {
  if (diagnosis.refused) {
    const Cause& cause = diagnosis.others.front();
    return fmt::format("{}: cannot be read\n1. {}\n   evidence: {}\n   remedy: {}\n", diagnosis.sequence,
                       cause.name, cause.evidence, cause.remedy);
  }
  std::string text = title(diagnosis);
  std::size_t number = 0;
  for (const Cause& cause : diagnosis.causes) {
    if (++number > kMaxCauses) break;
    text += fmt::format("{}. {}: error {} {}\n   evidence: {}\n   remedy: {}\n", number, cause.name,
                        effect_text(*cause.error_ratio),
                        cause.correction ? "without it" : "outside of the frames concerned", cause.evidence,
                        cause.remedy);
  }
  if (diagnosis.causes.empty() && !(diagnosis.foreign && has_unmeasured(diagnosis)))
    text += fmt::format("nothing found that changes the error by more than {:.0f} %\n",
                        100.0 * diagnosis.least_effect);
  text += others_text(diagnosis);
  if (!diagnosis.left_out.empty())
    text += fmt::format("left out, for lack of budget: {}\n", fmt::join(diagnosis.left_out, "; "));
  return text + (diagnosis.interrupted ? "interrupted\n" : "");
}

std::string diagnosis_json(const Diagnosis& diagnosis) {
  const nlohmann::ordered_json json = {
      {"schema", 3},
      {"sequence", diagnosis.sequence},
      {"measure", diagnosis.measure == ErrorMeasure::kTruth ? "ate" : "inconsistency"},
      {"frames", diagnosis.frames},
      {"seconds", diagnosis.seconds},
      {"error", diagnosis.error},
      {"corrected_error", diagnosis.corrected},
      {"least_effect", diagnosis.least_effect},
      {"trials", diagnosis.trials},
      {"finished_run", diagnosis.finished_run},
      {"other_system", diagnosis.foreign},
      {"interrupted", diagnosis.interrupted},
      {"left_out", diagnosis.left_out},
      {"causes", list(diagnosis.causes)},
      {"others", list(diagnosis.others)}};
  return json.dump(2) + "\n";
}

}  // namespace stillpoint::bench
