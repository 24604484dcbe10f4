// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/sequence_argument.h"

#include <algorithm>
#include <filesystem>

#include "bench/config/spelling.h"
#include "bench/plan/dataset_catalogue.h"
#include "bench/plan/plan_sequences.h"
#include "core/base/error.h"
#include "datasets/open_sequence.h"
#include "datasets/synthetic/sequence/presets.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void throw_unknown(const std::string& argument,
                                const std::vector<RegisteredSequence>& registry) {
  const std::string place = "sequence \"" + argument + "\"";
  std::error_code ignored;
  if (fs::exists(argument, ignored)) {
    throw InputError(place, "is a file; specify the folder of the sequence");
  }
  std::vector<std::string> names = synth::preset_names();
  for (const RegisteredSequence& known : registry) names.push_back(known.name);
  const std::string advice = fetch_advice(load_catalogues(), argument);
  if (!advice.empty()) throw InputError(place, "is not available; " + advice);
  throw InputError(
      place, "is neither a folder nor a preset nor a registered sequence" + suggestion(argument, names));
}

/// "tum/fr3_walking_xyz" as the name of its registration; other arguments unchanged.
std::string without_catalogue_name(const std::string& argument) {
  if (argument.find('/') == std::string::npos) return argument;
  const std::vector<datasets::CatalogueDataset> catalogues = load_catalogues();
  const std::vector<datasets::CatalogueEntry> entries = datasets::matching_entries(catalogues, argument);
  return entries.size() == 1 ? datasets::registered_name(*entries.front().dataset, *entries.front().sequence)
                             : argument;
}

}  // namespace

std::string resolve_sequence(const std::string& given) {
  const std::string argument = datasets::is_sequence_path(given) ? given : without_catalogue_name(given);
  if (datasets::is_sequence_path(argument)) return argument;
  const std::vector<std::string> presets = synth::preset_names();
  const bool is_preset = std::ranges::find(presets, argument) != presets.end();
  const std::vector<RegisteredSequence> registry = read_registry(registry_file());
  const auto registered = std::ranges::find(registry, argument, &RegisteredSequence::name);
  if (registered == registry.end()) {
    if (!is_preset) throw_unknown(argument, registry);
    return argument;
  }
  if (is_preset) {
    throw InputError(
        "sequence \"" + argument + "\"",
        "is a preset and a registered sequence; specify its folder: " + registered->folder.string() +
            ", or the one printed by `stillpoint data synth " + argument + "`");
  }
  return verified_sequence(*registered).folder.string();
}

}  // namespace stillpoint::bench
