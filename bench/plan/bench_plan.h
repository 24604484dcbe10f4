// SPDX-License-Identifier: BSD-3-Clause
/// A benchmark plan: sequences x variants x seeds x repetitions, and the layout of the result table; read
/// from a file and validated, so that errors are reported with the line of the plan before its first run.
/// Also the base of a stored plan's ablation, and the variants that are compared with it.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "bench/store/store.h"
#include "core/base/error.h"
#include "core/base/fields.h"

namespace stillpoint::bench {

enum class RunKind {
  kAccuracy,      ///< runs may execute in parallel
  kTiming,        ///< one run at a time, pinned to `cores`; the load of the machine is recorded
  kInstructions,  ///< under callgrind: counts instructions instead of measuring time
};
constexpr auto enum_names(RunKind) {
  return EnumNames<RunKind, 3>{{{RunKind::kAccuracy, "accuracy"},
                                {RunKind::kTiming, "timing"},
                                {RunKind::kInstructions, "instructions"}}};
}

/// Synthetic sequences, rendered on demand.
struct RenderedGroup {
  std::vector<std::string> sequences;  ///< names of presets, or globs ("walking_*")
  std::vector<std::string> variants;   ///< replaces `BenchPlan::variants` if not empty
  double seconds = 8.0;                ///< duration of each sequence; 0 = that of its preset
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, RenderedGroup>
void visit_fields(Visitor&& field, Config& config) {
  field("sequences", config.sequences);
  field("variants", config.variants);
  field("seconds", config.seconds, 0.0, 3600.0);
}

/// Recorded sequences.
struct RecordedGroup {
  std::vector<std::string> sequences;  ///< registered names, names in the data folder, globs over both, or
                                       ///< paths of folders (with a slash), relative to the plan, else to
                                       ///< the working folder
  std::vector<std::string> variants;   ///< replaces `BenchPlan::variants` if not empty
  bool required = true;                ///< false: sequences that are not available are skipped
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, RecordedGroup>
void visit_fields(Visitor&& field, Config& config) {
  field("sequences", config.sequences);
  field("variants", config.variants);
  field("required", config.required);
}

/// Layout of the result table.
struct TableLayout {
  /// Tables of published numbers to show as well: names ("tum_fr3_ate"), or files of the form of these,
  /// relative to the plan, else to the working folder, which `bench` prints and pages lack.
  std::vector<std::string> published;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, TableLayout>
void visit_fields(Visitor&& field, Config& config) { field("published", config.published); }

/// One-dimensional parameter sweep: the values of one key, all other keys unchanged.
struct SweepAxis {
  std::string key;  ///< of the config ("detector.simulated.miss_rate"), of the rendering ("synth.walkers"),
                    ///< or of the external systems that have it ("param.features")
  std::vector<double> values;
};

inline constexpr std::string_view kFaultSeparator = " + ";  ///< of sequence and fault in names of runs
/// Name of an undisturbed run in `BenchPlan::faults`.
inline constexpr std::string_view kNoFault = "none";

/// Values of `BenchPlan::expected`.
inline constexpr std::string_view kExpectSurvival = "survive";
inline constexpr std::string_view kExpectLoss = "lose";

struct BenchPlan {
  std::string title;
  std::string base = "stillpoint";    ///< config to which the variants are applied; see `config_of_plan`
  std::vector<std::string> variants;  ///< of this odometry
  std::string ablation_base;          ///< the variant that the others are compared with; empty: no ablation
  std::vector<std::string> systems;  ///< external systems: names, or files, relative to the plan, else to the
                                     ///< working folder; see bench/systems/external_system.h
  std::vector<int> seeds = {1};      ///< for rendering and for the odometry; see `PlannedRun::later_frames`
  int repetitions = 1;
  int max_frames = 0;  ///< process only the first frames of each sequence; 0 = all
  std::string mode = "sequential";
  RunKind kind = RunKind::kAccuracy;
  std::string cores;             ///< CPU affinity of the runs, e.g. "0,1"; empty = all processors
  int warm_up = 0;               ///< discarded runs before the first timing run of a sequence
  double time_limit_s = 3600.0;  ///< per run
  int memory_limit_mb = 0;       ///< per run; 0 = none
  /// Sensor faults, one run each: "none", or as `stillpoint run --fault`; empty = only "none".
  std::vector<std::string> faults;
  /// Per fault, what the first variant should do: "survive", or "lose" honestly; see `stats faults`. May be
  /// empty.
  std::vector<std::string> expected;
  std::vector<std::string> protocols;  ///< additional evaluation protocols, e.g. "strict:se3"
  int images = 20;  ///< annotated images of the worst frames per accuracy run; see `stillpoint run --images`
  bool frame_cache = true;  ///< false: every run decodes the images
  RenderedGroup rendered;
  RecordedGroup recorded;
  TableLayout table;
  // The tables [config], [synth] and [sweep], whose keys are those of `SweepAxis`.
  std::vector<std::string> config_settings;  ///< "key=value", applied to every variant
  std::vector<SweepAxis> synth_settings;     ///< one value each, applied to every rendered sequence
  std::vector<SweepAxis> sweep;
  // Origin of the plan.
  std::string name;                           ///< file name without extension
  std::string text;                           ///< content of the file
  std::string path;                           ///< of the file, as shown in messages
  std::map<std::string, std::string> places;  ///< "file:line" of each key that is set
  /// Where the configs and sequences are that the plan names by paths, which are the keys.
  std::map<std::string, std::string> files;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, BenchPlan>
void visit_fields(Visitor&& field, Config& config) {
  field("title", config.title);
  field("base", config.base);
  field("variants", config.variants);
  field("ablation_base", config.ablation_base);
  field("systems", config.systems);
  field("seeds", config.seeds, 0, 1000000000);
  field("repetitions", config.repetitions, 1, 10000);
  field("max_frames", config.max_frames, 0, 1000000000);
  field("mode", config.mode);
  field("kind", config.kind);
  field("cores", config.cores);
  field("warm_up", config.warm_up, 0, 100);
  field("time_limit_s", config.time_limit_s, 0.1, 1e6);
  field("memory_limit_mb", config.memory_limit_mb, 0, 1000000000);
  field("faults", config.faults);
  field("expected", config.expected);
  field("protocols", config.protocols);
  field("images", config.images, 0, 1000);
  field("frame_cache", config.frame_cache);
  field("rendered", config.rendered);
  field("recorded", config.recorded);
  field("table", config.table);
}

/// Reads a plan, loads each config of it, and checks its presets, sweeps, protocols, systems, processors and
/// published tables. Recorded sequences are checked when the plan is expanded.
/// @param name embedded name ("quick") or path of a TOML file
/// @param systems copies of the descriptions that the plan names, in its order; empty: those that it names
/// @param files   `BenchPlan::files` of a copied plan; paths that are not in it are found as in any plan
/// @throws InputError if it does not exist; with file and line of the plan for every fault of the file, an
/// unknown name (with the nearest one), a value out of range, and a seed, variant, system, protocol or sweep
/// value that is listed twice
[[nodiscard]] BenchPlan load_plan(const std::string& name, const std::vector<std::string>& systems = {},
                                  std::map<std::string, std::string> files = {});

/// The base or a variant of a plan as `load_config` finds it. A part that ends in ".toml" is a file relative
/// to the plan, else to the working folder.
/// @param name as in the plan, parts joined by "+"
/// @throws InputError if a file is in neither folder
[[nodiscard]] std::string config_of_plan(const BenchPlan& plan, const std::string& name);

/// Parses a CPU list such as "0,2-3".
/// @throws InputError if it is malformed, or the machine has no such processor
[[nodiscard]] std::vector<int> parse_cpu_list(const std::string& cores);

/// Place of a key in messages: "plan.toml:3"; the file alone, or the name of the plan, if the key is not set.
[[nodiscard]] inline std::string place_of(const BenchPlan& plan, const std::string& key) {
  const auto found = plan.places.find(key);
  if (found != plan.places.end()) return found->second;
  return plan.path.empty() ? "plan \"" + plan.name + "\"" : plan.path;
}

/// Result of `action`.
/// @throws InputError the error of `action`, preceded by the place of the key
template <class Action>
decltype(auto) at_place(const BenchPlan& plan, const std::string& key, const Action& action) {
  try {
    return action();
  } catch (const InputError& error) {
    throw InputError(place_of(plan, key), error.what());
  }
}

/// Requires that the plan names a sequence, that each group of sequences has a variant or a system, and that
/// it has what a sweep and [synth] vary.
/// @throws InputError with the missing key
void require_runs(const BenchPlan& plan);

/// The key `ablation_base` of a plan, from its stored text.
/// @return nullopt without that key, as in plans of older versions, or if the text is not valid TOML
[[nodiscard]] std::optional<std::string> ablation_base_of(const StoredPlan& plan);

/// Variants that are compared with the same base.
struct AblationGroup {
  std::string base;
  std::vector<std::string> variants;  ///< without the base, in the order of the plan
};

/// Assigns each variant of a plan to its base: "a+b+c" is compared with "a+b" if the plan contains it, else
/// with "a" if the plan contains it, else with the base of the plan. An overlay of another system is so never
/// compared with the system of the plan's base.
/// @param variants of the plan, each once
/// @return the group of the plan's base first; groups without variants are omitted; none if `variants` does
/// not contain `base`
[[nodiscard]] std::vector<AblationGroup> ablation_groups(const std::string& base,
                                                         std::span<const std::string> variants);

}  // namespace stillpoint::bench
