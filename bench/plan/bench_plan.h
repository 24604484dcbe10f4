// SPDX-License-Identifier: BSD-3-Clause
/// Which variants are run on which sequences: one table.
#pragma once

#include <string>
#include <type_traits>
#include <vector>

namespace stillpoint {

/// Sequences that the program renders itself.
struct RenderedGroup {
  std::vector<std::string> sequences;  ///< names of presets
  std::vector<std::string> variants;
  double seconds = 8.0;  ///< length of each
  int seed = 1;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, RenderedGroup>
void visit_fields(Visitor&& field, Config& config) {
  field("sequences", config.sequences);
  field("variants", config.variants);
  field("seconds", config.seconds, 1.0, 3600.0);
  field("seed", config.seed, 0, 1000000000);
}

/// Recorded sequences, which take part where they are at hand.
struct RecordedGroup {
  std::vector<std::string> sequences;  ///< folders below the data folder
  std::vector<std::string> variants;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, RecordedGroup>
void visit_fields(Visitor&& field, Config& config) {
  field("sequences", config.sequences);
  field("variants", config.variants);
}

struct BenchPlan {
  std::string title;
  RenderedGroup rendered;
  RecordedGroup recorded;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, BenchPlan>
void visit_fields(Visitor&& field, Config& config) {
  field("title", config.title);
  field("rendered", config.rendered);
  field("recorded", config.recorded);
}

/// Reads a plan.
/// @param name embedded name ("quick") or a TOML file
/// @throws InputError if there is none, for every fault of the file, and for a variant that does not load
[[nodiscard]] BenchPlan load_plan(const std::string& name);

}  // namespace stillpoint
