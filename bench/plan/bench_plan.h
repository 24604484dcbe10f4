// SPDX-License-Identifier: BSD-3-Clause
/// A benchmark plan: sequences x variants x seeds x repetitions, and the layout of the result table.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

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
                                       ///< paths of folders (with a slash)
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
  std::vector<std::string> published;  ///< tables of published numbers to show as well, e.g. "tum_fr3_ate"
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, TableLayout>
void visit_fields(Visitor&& field, Config& config) { field("published", config.published); }

/// One-dimensional parameter sweep: the values of one key, all other keys unchanged.
struct SweepAxis {
  std::string key;  ///< of the config ("detector.simulated.miss_rate") or of the rendering ("synth.walkers")
  std::vector<double> values;
};

/// Name of an undisturbed run in `BenchPlan::faults`.
inline constexpr std::string_view kNoFault = "none";

/// Values of `BenchPlan::expected`.
inline constexpr std::string_view kExpectSurvival = "survive";
inline constexpr std::string_view kExpectLoss = "lose";

struct BenchPlan {
  std::string title;
  std::string base = "stillpoint";    ///< config to which the variants are applied
  std::vector<std::string> variants;  ///< of this odometry
  std::string ablation_base;          ///< the variant that the others are compared with; empty: no ablation
  std::vector<std::string> systems;   ///< external systems: files, see bench/systems/external_system.h
  std::vector<int> seeds = {1};       ///< for rendering and for the odometry
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
  // The tables [config], [synth] and [sweep], whose keys are those of the config and of the rendering.
  std::vector<std::string> config_settings;  ///< "key=value", applied to every variant
  std::vector<SweepAxis> synth_settings;     ///< one value each, applied to every rendered sequence
  std::vector<SweepAxis> sweep;
  // Origin of the plan.
  std::string name;                           ///< file name without extension
  std::string text;                           ///< content of the file
  std::string path;                           ///< of the file, as shown in messages
  std::map<std::string, std::string> places;  ///< "file:line" of each key that is set
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

/// Reads a plan and validates everything that it refers to.
/// @param name embedded name ("quick") or path of a TOML file
/// @throws InputError if it does not exist, for every fault of the file, and for an unknown variant, protocol
/// or key
[[nodiscard]] BenchPlan load_plan(const std::string& name);

/// Parses a CPU list such as "0,2-3".
/// @throws InputError if it is malformed, or the machine has no such processor
[[nodiscard]] std::vector<int> parse_cpu_list(const std::string& cores);

}  // namespace stillpoint::bench
