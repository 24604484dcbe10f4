// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/plan_matrix.h"

#include <fnmatch.h>

#include <algorithm>
#include <unordered_map>

#include <fmt/format.h>

#include "bench/config/config_hash.h"
#include "bench/process/child_process.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/faults/sensor_fault.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

std::string kind_name(RunKind kind) {
  for (const auto& [value, name] : enum_names(kind)) {
    if (value == kind) return std::string(name);
  }
  return "";
}

/// Builds the matrix sequence by sequence.
class PlanExpander {
 public:
  PlanExpander(const BenchPlan& plan, std::string build) : build_(std::move(build)) {
    matrix_.plan = plan;
    for (const std::string& name : plan.systems) matrix_.systems.push_back(load_external_system(name));
    for (const SweepAxis& axis : plan.sweep) {
      for (const double value : axis.values) sweep_points_.push_back({axis.key, {value}});
    }
    if (sweep_points_.empty()) sweep_points_.push_back({});
    if (matrix_.plan.faults.empty()) matrix_.plan.faults.emplace_back(kNoFault);
  }

  PlanMatrix expand() && {
    const BenchPlan& plan = matrix_.plan;
    for (const std::string& preset : matching_presets(plan.rendered.sequences)) {
      for (const int seed : plan.seeds) add_rendered(preset, seed);
    }
    const std::vector<PlanSequence> recorded =
        at_place(plan, "recorded.sequences", [&] { return recorded_sequences(plan.recorded); });
    for (const PlanSequence& sequence : recorded) {
      matrix_.sequences.push_back(sequence);
      later_frames_ = 0;
      for (const int seed : plan.seeds) {
        add_recorded(seed);
        ++later_frames_;
      }
      later_frames_ = 0;
    }
    return std::move(matrix_);
  }

 private:
  /// Each sweep point of a rendering parameter has its own sequence; the other points share one.
  void add_rendered(const std::string& preset, int seed) {
    std::string id;
    for (const SweepAxis& point : sweep_points_) {
      const bool is_rendering_point = point.key.starts_with(kSynthPrefix);
      PlanSequence sequence =
          rendered_sequence(matrix_.plan, preset, seed, is_rendering_point ? point : SweepAxis{});
      if (sequence.id != id) matrix_.sequences.push_back(sequence);
      id = sequence.id;
      add_repetitions(matrix_.plan.rendered.variants, seed, point);
    }
  }

  void add_recorded(int seed) {
    for (const SweepAxis& point : sweep_points_) {
      if (!point.key.starts_with(kSynthPrefix)) add_repetitions(matrix_.plan.recorded.variants, seed, point);
    }
  }

  void add_repetitions(const std::vector<std::string>& group_variants, int seed, const SweepAxis& point) {
    const std::vector<std::string>& variants =
        group_variants.empty() ? matrix_.plan.variants : group_variants;
    for (int repetition = 1; repetition <= matrix_.plan.repetitions; ++repetition) {
      RunIdentity identity = identity_of(seed, repetition, point);
      for (const std::string& fault : matrix_.plan.faults) {
        if (point.key.starts_with(kParamPrefix)) continue;
        for (const std::string& variant : variants) add_own(identity, variant, fault);
      }
      for (std::size_t i = 0; i < matrix_.systems.size(); ++i) {
        if (!varies_system(point, matrix_.systems[i])) continue;
        for (const std::string& fault : matrix_.plan.faults) add_external(identity, i, fault);
      }
    }
  }

  /// Whether a system has runs at a sweep point: of the scene, or of one of its parameters.
  [[nodiscard]] static bool varies_system(const SweepAxis& point, const ExternalSystem& system) {
    if (point.key.empty() || point.key.starts_with(kSynthPrefix)) return true;
    return point.key.starts_with(kParamPrefix) &&
           system.param.contains(point.key.substr(kParamPrefix.size()));
  }

  [[nodiscard]] RunIdentity identity_of(int seed, int repetition, const SweepAxis& point) const {
    const PlanSequence& sequence = matrix_.sequences.back();
    return {.sequence = sequence.name,
            .sequence_id = sequence.id + frame_limit_suffix(),
            .mode = matrix_.plan.mode,
            .kind = kind_name(matrix_.plan.kind),
            .cores = matrix_.plan.cores,
            .seed = seed,
            .repetition = repetition,
            .axis = point.key,
            .axis_value = point.key.empty() ? 0.0 : point.values.front()};
  }

  /// Distinguishes the truncated sequence from the whole one.
  [[nodiscard]] std::string frame_limit_suffix() const {
    return matrix_.plan.max_frames == 0 ? "" : fmt::format("-first-{}", matrix_.plan.max_frames);
  }

  /// A sequence with a fault is a different sequence: it has its own name and id, so that runs with different
  /// faults are neither paired nor averaged.
  /// @return the injected fault, canonical; empty for none
  static std::string inject(RunIdentity& identity, const std::string& fault) {
    if (fault == kNoFault) return "";
    std::string injected = fault_text(datasets::parse_fault(fault));
    identity.sequence += std::string(kFaultSeparator) + fault;
    identity.sequence_id += "-" + injected;
    return injected;
  }

  void add_own(RunIdentity identity, const std::string& variant, const std::string& fault) {
    std::string injected = inject(identity, fault);
    std::vector<std::string> settings = matrix_.plan.config_settings;
    settings.push_back(fmt::format("seed={}", identity.seed));
    if (!identity.axis.empty() && !identity.axis.starts_with(kSynthPrefix)) {
      settings.push_back(fmt::format("{}={}", identity.axis, identity.axis_value));
    }
    ConfigRequest config{config_of_plan(matrix_.plan, matrix_.plan.base),
                         config_of_plan(matrix_.plan, variant), settings};
    identity.variant = variant;
    identity.build = build_;
    identity.config_hash = hash_of(config, identity);
    matrix_.runs.push_back({.sequence = matrix_.sequences.size() - 1,
                            .identity = std::move(identity),
                            .config = std::move(config),
                            .max_frames = matrix_.plan.max_frames,
                            .later_frames = later_frames_,
                            .fault = std::move(injected),
                            .system = 0});
  }

  void add_external(RunIdentity identity, std::size_t index, const std::string& fault) {
    const ExternalSystem& system = matrix_.systems[index];
    std::string injected = inject(identity, fault);
    identity.system = system.name;
    identity.variant = system.variant;
    identity.build = system.version;
    identity.config_hash = system.hash;
    identity.mode = matrix_.plan.mode == "realtime" ? "external, realtime" : "external";
    // The recorded files cannot begin later.
    const bool is_later = system.layout != ExportLayout::kAsIs;
    matrix_.runs.push_back({.sequence = matrix_.sequences.size() - 1,
                            .identity = std::move(identity),
                            .config = {},
                            .max_frames = matrix_.plan.max_frames,
                            .later_frames = is_later ? later_frames_ : 0,
                            .fault = std::move(injected),
                            .system = index});
  }

  /// Hash of the config of a run; configs differ only in the seed for all seeds.
  std::string hash_of(const ConfigRequest& config, const RunIdentity& identity) {
    const std::string name =
        fmt::format("{}\x1f{}\x1f{}", config.variant, identity.axis, identity.axis_value);
    const std::string key = fmt::format("{}\x1f{}", name, identity.seed);
    if (const auto known = hashes_.find(key); known != hashes_.end()) return known->second;
    auto loaded = configs_.find(name);
    if (loaded == configs_.end()) loaded = configs_.emplace(name, load_config(config)).first;
    loaded->second.seed = static_cast<int>(identity.seed);
    return hashes_[key] = config_hash(loaded->second);
  }

  std::string build_;
  PlanMatrix matrix_;
  int later_frames_ = 0;  ///< of the runs that are added
  std::unordered_map<std::string, OdometryConfig> configs_;
  std::unordered_map<std::string, std::string> hashes_;
  std::vector<SweepAxis> sweep_points_;  ///< one value each; one point with an empty key if there is no sweep
};

bool matches_all(const RunIdentity& identity, const std::vector<std::string>& filters) {
  return std::all_of(filters.begin(), filters.end(), [&](const std::string& filter) {
    const auto matches = [&](const std::string& name) {
      return fnmatch(filter.c_str(), name.c_str(), 0) == 0;
    };
    return matches(identity.sequence) || matches(identity.variant) || matches(identity.system);
  });
}

}  // namespace

PlanMatrix expand_plan(const BenchPlan& plan, const std::string& build,
                       const std::vector<std::string>& filters) {
  PlanMatrix matrix = PlanExpander(plan, build).expand();
  require_runs(plan);
  for (const PlannedRun& run : matrix.runs) matrix.keys.push_back(run_key(run.identity));
  std::erase_if(matrix.runs, [&](const PlannedRun& run) { return !matches_all(run.identity, filters); });
  return matrix;
}

std::string run_label(const BenchPlan& plan, const RunIdentity& identity) {
  std::string label = identity.sequence + " " + identity.variant;
  if (plan.seeds.size() > 1) label += fmt::format(" seed {}", identity.seed);
  if (plan.repetitions > 1) label += fmt::format(" repetition {}", identity.repetition);
  if (!identity.axis.empty()) label += fmt::format(" {} = {}", identity.axis, identity.axis_value);
  return label;
}

namespace {

constexpr double kProbeLimit_s = 30.0;

/// Identifies a program by its content, so that a new build invalidates the cached runs.
std::string program_hash(const std::filesystem::path& program) {
  return hash_text(content_hash(eval::read_text_file(program)));
}

bool accepts_perturbation(const std::filesystem::path& program) {
  const ProcessResult result = run_process(
      {.program = program,
       .arguments = {"config", "show", "--set", fmt::format("{}=1", kPerturbationKey), "--variant", "vo"},
       .time_limit_s = kProbeLimit_s});
  return result.exit_code == 0 && result.signal == 0 && !result.timed_out;
}

/// Run `repetition` of a program, perturbed except for the first.
PlannedRun repeated(PlannedRun run, int repetition, bool perturbed) {
  run.identity.repetition = repetition;
  if (!perturbed || repetition == 1 || run.identity.axis == kPerturbationKey) return run;
  run.config.settings.push_back(fmt::format("{}={}", kPerturbationKey, repetition - 1));
  run.identity.config_hash = config_hash(load_config(run.config));
  return run;
}

PlannedRun of_program(PlannedRun run, const std::filesystem::path& program, const std::string& build) {
  run.program = program;
  run.identity.build = build;
  return run;
}

}  // namespace

// The prefixes distinguish the two sides if both are the same program.
std::string ProgramPair::base_build() const { return "base-" + program_hash(base); }
std::string ProgramPair::head_build() const { return "head-" + program_hash(head); }

bool accept_perturbation(const ProgramPair& programs) {
  return accepts_perturbation(programs.base) && accepts_perturbation(programs.head);
}

PlanMatrix single_runs(BenchPlan plan) {
  if (plan.kind != RunKind::kInstructions) plan.kind = RunKind::kTiming;
  plan.repetitions = 1;
  plan.systems.clear();
  return expand_plan(plan, "", {});
}

namespace {

PlanMatrix with_keys(PlanMatrix matrix) {
  matrix.keys.clear();
  for (const PlannedRun& run : matrix.runs) matrix.keys.push_back(run_key(run.identity));
  return matrix;
}

/// The two runs of a pair.
struct RunSides {
  PlannedRun base;
  PlannedRun head;
};

/// Each run of the matrix as `pairs` pairs, in the order base, head, head, base.
/// @param sides (run, repetition) -> RunSides
template <class Sides>
PlanMatrix in_pairs(PlanMatrix runs, int pairs, const Sides& sides) {
  PlanMatrix matrix = std::move(runs);
  matrix.plan.repetitions = pairs;
  const std::vector<PlannedRun> single = std::move(matrix.runs);
  matrix.runs.clear();
  for (auto first = single.begin(); first != single.end();) {
    auto last = first;  // one after the runs on the same sequence
    while (last != single.end() && last->sequence == first->sequence) ++last;
    for (int repetition = 1; repetition <= pairs; ++repetition) {
      for (auto run = first; run != last; ++run) {
        RunSides pair = sides(*run, repetition);
        if (repetition % 2 == 0) std::swap(pair.base, pair.head);
        matrix.runs.push_back(std::move(pair.base));
        matrix.runs.push_back(std::move(pair.head));
      }
    }
    first = last;
  }
  return with_keys(std::move(matrix));
}

}  // namespace

PlanMatrix paired_plan(PlanMatrix runs, const ProgramPair& programs, int pairs) {
  const std::string base_build = programs.base_build();
  const std::string head_build = programs.head_build();
  return in_pairs(std::move(runs), pairs, [&](const PlannedRun& run, int repetition) {
    const PlannedRun planned = repeated(run, repetition, programs.perturbed);
    return RunSides{of_program(planned, programs.base, base_build),
                    of_program(planned, programs.head, head_build)};
  });
}

BenchPlan plan_of_system(BenchPlan plan, const std::string& system) {
  if (plan.kind == RunKind::kInstructions)
    throw InputError(place_of(plan, "kind"), "instructions are counted for this odometry only");
  plan.variants.clear();
  plan.rendered.variants.clear();
  plan.recorded.variants.clear();
  plan.systems = {system};
  return plan;
}

PlanMatrix with_version(PlanMatrix runs, const ExternalSystem& version, const std::string& commit_time) {
  runs.systems = {version};
  for (PlannedRun& run : runs.runs) {
    run.identity.build = version.version;
    run.identity.config_hash = version.hash;
    run.commit_time = commit_time;
  }
  return with_keys(std::move(runs));
}

PlanMatrix with_program(PlanMatrix runs, const BuiltProgram& built) {
  for (PlannedRun& run : runs.runs) {
    run.program = built.program;
    run.identity.build = built.commit;
    run.commit_time = built.commit_time;
  }
  return with_keys(std::move(runs));
}

PlanMatrix single_system_runs(BenchPlan plan, const std::string& system) {
  plan = plan_of_system(std::move(plan), system);
  plan.kind = RunKind::kTiming;
  plan.repetitions = 1;
  return expand_plan(plan, "", {});
}

PlanMatrix paired_systems(PlanMatrix runs, const SystemPair& systems, int pairs) {
  runs.systems = {systems.base, systems.head};
  return in_pairs(std::move(runs), pairs, [&](const PlannedRun& run, int repetition) {
    RunSides sides{run, run};
    sides.head.system = 1;
    for (PlannedRun* side : {&sides.base, &sides.head}) {
      const ExternalSystem& system = side->system == 0 ? systems.base : systems.head;
      side->identity.system = system.name;
      side->identity.variant = system.variant;
      side->identity.config_hash = system.hash;
      side->identity.build = system_build(system, side->system == 0);
      side->identity.repetition = repetition;
    }
    return sides;
  });
}

std::string system_build(const ExternalSystem& system, bool is_base) {
  return (is_base ? "base-" : "head-") + system.hash;
}

}  // namespace stillpoint::bench
