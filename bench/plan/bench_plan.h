// SPDX-License-Identifier: BSD-3-Clause
/// What is to be run: sequences x variants x seeds x repetitions, and how it is shown.
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "core/base/fields.h"

namespace stillpoint {

enum class RunKind {
  kAccuracy,      ///< may run beside others
  kTiming,        ///< one at a time, pinned, the machine's state recorded
  kInstructions,  ///< under callgrind: instructions are counted instead of time
};
constexpr auto enum_names(RunKind) {
  return EnumNames<RunKind, 3>{{{RunKind::kAccuracy, "accuracy"},
                                {RunKind::kTiming, "timing"},
                                {RunKind::kInstructions, "instructions"}}};
}

/// Sequences that the program renders itself.
struct RenderedGroup {
  std::vector<std::string> sequences;  ///< names of presets, or globs over them ("walking_*")
  std::vector<std::string> variants;   ///< instead of the plan's
  double seconds = 8.0;                ///< length of each
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, RenderedGroup>
void visit_fields(Visitor&& field, Config& config) {
  field("sequences", config.sequences);
  field("variants", config.variants);
  field("seconds", config.seconds, 1.0, 3600.0);
}

/// Recorded sequences.
struct RecordedGroup {
  std::vector<std::string>
      sequences;  ///< registered names or folders below the data folder, or globs over both
  std::vector<std::string> variants;  ///< instead of the plan's
  bool required = true;               ///< otherwise they take part where they are at hand
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, RecordedGroup>
void visit_fields(Visitor&& field, Config& config) {
  field("sequences", config.sequences);
  field("variants", config.variants);
  field("required", config.required);
}

/// How the runs are shown.
struct TableLayout {
  std::vector<std::string> published;  ///< tables of published numbers to stand beside, e.g. "tum_fr3_ate"
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, TableLayout>
void visit_fields(Visitor&& field, Config& config) { field("published", config.published); }

/// Values that one key takes in turn while everything else stays: a curve for each variant.
struct SweepAxis {
  std::string key;  ///< of the config ("detector.simulated.miss_rate") or of the rendering ("synth.walkers")
  std::vector<double> values;
};

struct BenchPlan {
  std::string title;
  std::string base = "stillpoint";    ///< config that the variants change
  std::vector<std::string> variants;  ///< of our odometry
  std::vector<std::string> systems;   ///< other systems: files, see bench/systems/external_system.h
  std::vector<int> seeds = {1};       ///< of renderings and of the odometry
  int repetitions = 1;
  int max_frames = 0;  ///< pictures from the start of each sequence; 0 = all
  std::string mode = "sequential";
  RunKind kind = RunKind::kAccuracy;
  std::string cores;                 ///< processors for timing runs, e.g. "0,1"; empty = all
  int warm_up = 0;                   ///< runs made and thrown away before the first timing run of a sequence
  double time_limit_s = 3600.0;      ///< of one run
  int memory_limit_mb = 0;           ///< of one run; 0 = none
  std::vector<std::string> recipes;  ///< evaluated besides the usual scores, e.g. "strict:se3"
  int pictures =
      20;  ///< of the worst frames of each accuracy run, for the page; see `stillpoint run --pictures`
  RenderedGroup rendered;
  RecordedGroup recorded;
  TableLayout table;
  // What follows has keys of its own choice: the tables [config], [synth] and [sweep].
  std::vector<std::string> config_settings;  ///< "key=value", for every variant
  std::vector<SweepAxis> synth_settings;     ///< one value each, for every rendering
  std::vector<SweepAxis> sweep;
  // Where it came from.
  std::string name;
  std::string text;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, BenchPlan>
void visit_fields(Visitor&& field, Config& config) {
  field("title", config.title);
  field("base", config.base);
  field("variants", config.variants);
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
  field("recipes", config.recipes);
  field("pictures", config.pictures, 0, 1000);
  field("rendered", config.rendered);
  field("recorded", config.recorded);
  field("table", config.table);
}

/// Reads a plan, and every config that it names.
/// @param name embedded name ("quick") or a TOML file
/// @throws InputError if there is none, for every fault of the file, and for a variant, recipe or key that is
/// not known
[[nodiscard]] BenchPlan load_plan(const std::string& name);

/// The processors of a list like "0,2-3".
/// @throws InputError if it is no such list, or the machine has none of that number
[[nodiscard]] std::vector<int> processors_of(const std::string& cores);

}  // namespace stillpoint
