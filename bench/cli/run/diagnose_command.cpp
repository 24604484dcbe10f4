// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint diagnose`: what limits the accuracy on a recording, with evidence, measured effect and remedy.
#include <algorithm>
#include <chrono>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/cli/run/finished_run.h"
#include "bench/cli/run/foreign_run.h"
#include "bench/cli/run/profile_report.h"
#include "bench/cli/run/sequence_playback.h"
#include "bench/diagnose/diagnosis.h"
#include "bench/diagnose/diagnosis_text.h"
#include "bench/diagnose/evidence/recording_survey.h"
#include "bench/plan/plan_sequences.h"
#include "bench/plan/sequence_registry.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

struct DiagnoseArguments {
  std::string sequence, run, store, format, rig, base, variant, budget = "60s";
  std::vector<std::string> settings, topics, faults;
  double start_s = 0.0, length_s = 15.0;
  bool json = false, truth = false;
};

/// The config of the trials: without an IMU and without boxes where there are none.
ConfigRequest config_of(const DiagnoseArguments& arguments, const datasets::SequenceInfo& info) {
  ConfigRequest request{arguments.base.empty() ? "stillpoint" : arguments.base, arguments.variant,
                        arguments.settings};
  if (arguments.variant.empty() && (info.imu.empty() || !info.rig.has_imu)) request.variant = "vo";
  if (info.detections.empty()) request.settings.emplace_back("detector.kind=none");
  return request;
}

/// @param name folder, bag, registered name or preset
/// @return null if interrupted
std::unique_ptr<datasets::SensorStream> open_recording(const DiagnoseArguments& arguments,
                                                       const std::string& name) {
  auto stream = open_with_progress(resolve_sequence(name),
                                   {.format = arguments.format,
                                    .rig_file = arguments.rig,
                                    .topics = arguments.topics,
                                    .defer_color = true,
                                    .frame_cache = logged_frame_cache(arguments.start_s == 0.0, 0)});
  if (!stream) return nullptr;
  for (const std::string& note : stream->info().notes) spdlog::info("{}", note);
  return played(std::move(stream), {.start_s = arguments.start_s, .faults = parsed_faults(arguments.faults)});
}

/// The run of the arguments; nullopt without one.
std::optional<OdometryRun> finished_run(const DiagnoseArguments& arguments,
                                        const datasets::SequenceInfo& info) {
  if (arguments.run.empty()) return std::nullopt;
  // Not in the braces below: g++ 12 destroys members of an aggregate twice if an initializer throws.
  const OdometryConfig config = load_config(config_of(arguments, info));
  const std::vector<datasets::SensorFault> faults = parsed_faults(arguments.faults);
  const FinishedRunSource source{arguments.run, arguments.store};
  const RunConditions conditions{.info = info, .config = config, .faults = faults, .rig_file = arguments.rig};
  return is_foreign(source) ? read_foreign_run(source, conditions) : read_finished_run(source, conditions);
}

/// @param start of the budget: opening a recording counts
DiagnosisOptions options_of(const DiagnoseArguments& arguments, const datasets::SequenceInfo& info,
                            std::chrono::steady_clock::time_point start) {
  std::optional<OdometryRun> finished = finished_run(arguments, info);  // may throw
  return {
      .config = config_of(arguments, info),
      .budget_s = parse_duration_s(arguments.budget, "--budget"),
      .elapsed_s =
          [start] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); },
      .finished = std::move(finished),
      .foreign = !arguments.run.empty() && is_foreign({arguments.run, arguments.store}),
      .length_s = arguments.length_s,
      .stop_requested = interrupt_requested,
      .on_step = [](const std::string& step) { spdlog::debug("{}", step); }};
}

/// What --truth found of all sequences.
struct TruthFindings {
  std::string contradictions, undetermined;  ///< one line each
  bool compared = false;                     ///< at least one property of a sequence
  bool unreadable = false;                   ///< a sequence

  void add(const datasets::SequenceInfo& info, const TruthReport& report) {
    for (const Cause& cause : truth_causes(report, info))
      contradictions += fmt::format("{}: {}: {}; {}\n", info.name, cause.name, cause.evidence, cause.remedy);
    constexpr std::size_t kProperties = 3;
    const std::vector<std::string> missing = undetermined_of_truth(report);
    compared = compared || missing.size() < kProperties;
    if (missing.size() == kProperties)
      undetermined += fmt::format("{}: nothing could be compared: {}\n", info.name,
                                  report.poses == 0 ? "no ground truth"
                                                    : "too few images, or too little rotation "
                                                      "that images and ground truth have in common");
    else if (!missing.empty())
      undetermined +=
          fmt::format("{}: not determined by the motion: {}\n", info.name, fmt::join(missing, ", "));
  }

  [[nodiscard]] std::string text() const {
    if (!contradictions.empty() || !compared) return contradictions + undetermined;
    return undetermined + "nothing that the other sensors contradict\n";
  }
  [[nodiscard]] int exit_code() const {
    if (!contradictions.empty()) return kExitFindings;
    return compared && !unreadable ? kExitOk : kExitInconclusive;
  }
};

/// --truth: one row per sequence, and what it contradicts. A sequence of several that cannot be read is
/// reported in its row.
int check_truths(const DiagnoseArguments& arguments) {
  std::vector<std::string> names = {arguments.sequence};
  if (arguments.sequence.empty()) {
    names.clear();
    for (const RegisteredSequence& sequence : read_registry(registry_file())) names.push_back(sequence.name);
    if (names.empty())
      throw InputError("--truth", "no sequence is registered; name one, or use `stillpoint data add`");
  }
  std::cout << truth_table_header();
  TruthFindings findings;
  for (const std::string& name : names) {
    try {
      const auto start = std::chrono::steady_clock::now();
      const auto stream = open_recording(arguments, name);
      if (!stream || interrupt_requested()) return kExitInterrupted;
      const TruthReport report = check_truth(*stream, options_of(arguments, stream->info(), start));
      std::cout << truth_table_row(stream->info().name, report, stream->info()) << std::flush;
      findings.add(stream->info(), report);
    } catch (const InputError& error) {
      if (names.size() == 1) throw;
      std::cout << fmt::format("{:<24} {}\n", name, error.what());
      findings.unreadable = true;
    }
  }
  std::cout << findings.text();
  return findings.exit_code();
}

/// @throws InputError for a config with a run of another system: trials, which use it, are left out
void require_effect(const DiagnoseArguments& arguments) {
  if (arguments.run.empty() || !is_foreign({arguments.run, arguments.store})) return;
  const std::string set = arguments.settings.empty() ? "" : arguments.settings.front();
  for (const auto& [option, value] : {std::pair<const char*, std::string>{"--config", arguments.base},
                                      {"--variant", arguments.variant},
                                      {"--set", set}}) {
    if (!value.empty())
      throw InputError(option, "has no effect on the diagnosis of a run of another system; omit it");
  }
}

int diagnose_sequence(const DiagnoseArguments& arguments) {
  static_cast<void>(parse_duration_s(arguments.budget, "--budget"));
  install_interrupt_handlers();
  if (arguments.run.empty() && !arguments.store.empty())
    throw InputError("--store", "requires SEQ and the key of a run; see `stillpoint store list`");
  require_effect(arguments);
  if (arguments.truth && !arguments.run.empty() && !is_foreign({arguments.run, arguments.store}))
    throw InputError("--truth",
                     "compares the ground truth with a run without IMU of its own; leave RUN out, or name "
                     "one of another system");
  if (arguments.truth && arguments.json)
    throw InputError("--json", "has no effect on the table of --truth; omit one of them");
  if (arguments.truth) return check_truths(arguments);
  if (arguments.sequence.empty())
    throw InputError("SEQ", "is missing; only --truth works on all registered sequences");
  const auto start = std::chrono::steady_clock::now();
  std::unique_ptr<datasets::SensorStream> stream;
  try {
    stream = open_recording(arguments, arguments.sequence);
  } catch (const datasets::SensorRangeError& error) {
    const Diagnosis refused = refused_recording(arguments.sequence, error);
    std::cout << (arguments.json ? diagnosis_json(refused) : diagnosis_text(refused));
    return kExitFindings;
  }
  if (!stream) return kExitInterrupted;
  if (arguments.run.empty()) require_depth_or_imu(*stream);
  const Diagnosis diagnosis = diagnose(*stream, options_of(arguments, stream->info(), start));
  std::cout << (arguments.json ? diagnosis_json(diagnosis) : diagnosis_text(diagnosis));
  if (diagnosis.interrupted) return kExitInterrupted;
  const bool is_found = !diagnosis.causes.empty() || (diagnosis.foreign && has_unmeasured(diagnosis));
  return is_found ? kExitFindings : kExitOk;
}

}  // namespace

Command diagnose_command() {
  const auto a = std::make_shared<DiagnoseArguments>();
  return {
      .name = "diagnose",
      .summary = "Tell what limits the accuracy on a recording, with measured effects and remedies",
      .example = "diagnose walking_xyz --budget 30s",
      .options =
          {{.name = "SEQ",
            .help = "Sequence folder, bag or preset name; with --truth [all registered sequences]",
            .target = &a->sequence,
            .may_be_omitted = true},
           {.name = "RUN",
            .help = "Finished run of SEQ, in place of the first one: output folder of `run`, or a key with "
                    "--store. Of another system, or a trajectory of the camera: what the data, the run and "
                    "the ground truth tell",
            .target = &a->run,
            .may_be_omitted = true},
           {"--store", "Store that contains RUN", &a->store},
           {"--budget", "Time for the whole diagnosis, such as 30s or 2m", &a->budget},
           {"--length", "Length of the part of the recording that is used [15 s]", &a->length_s, {2, 1e4}},
           {"--start", "Time after the first frame at which that part begins [0 s]", &a->start_s, {0, 1e9}},
           {"--rig", kRigHelp, &a->rig},
           {"--config", "Base config: an embedded name or a TOML file [stillpoint]", &a->base},
           {"--variant", "Overlays joined by + [vo without an IMU]", &a->variant},
           {"--set", "Override a config key: key=value; may be repeated", &a->settings},
           {"--fault", "Inject a sensor fault, as `run --fault`; may be repeated", &a->faults},
           {"--format", "Sequence format: " + datasets::sequence_format_names() + " [detected]", &a->format},
           {"--topics", kTopicsHelp, &a->topics},
           {"--truth", "Only compare the ground truth with the other sensors", &a->truth},
           {"--json", "Print JSON with all candidates", &a->json}},
      .action = [a] { return diagnose_sequence(*a); }};
}

}  // namespace stillpoint::bench
