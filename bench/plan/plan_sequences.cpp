// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/plan_sequences.h"

#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <type_traits>

#include <fmt/format.h>

#include "bench/config/spelling.h"
#include "bench/plan/sequence_registry.h"
#include "bench/record/sequence_checksum.h"
#include "bench/run/frame_cache.h"
#include "bench/run/sequence_source.h"
#include "core/base/error.h"
#include "datasets/open_sequence.h"

namespace stillpoint::bench {
namespace {

constexpr double kMaxMagnitude = 1e9;  // far above any sensible value; fits in an int

/// Visits all fields and sets the one with the given key; collects all keys for the error message.
class NumberSetter {
 public:
  NumberSetter(std::string key, double value) : key_(std::move(key)), value_(value) {}

  template <class Field>
  void operator()(const std::string& name, Field&& field) {
    using Value = std::remove_cvref_t<Field>;
    if constexpr (std::is_same_v<Value, double> || std::is_same_v<Value, int>) {
      visit_number(prefix_ + name, field);
    } else if constexpr (std::is_class_v<Value> && !std::is_same_v<Value, std::string>) {
      const std::string outer = prefix_;
      prefix_ += name + ".";
      visit_fields(*this, field);
      prefix_ = outer;
    }
  }

  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] const std::vector<std::string>& known() const { return known_; }

 private:
  template <class Number>
  void visit_number(const std::string& key, Number& number) {
    known_.push_back(key);
    if (key != key_) return;
    found_ = true;
    if (std::is_same_v<Number, int> && value_ != std::floor(value_)) {
      throw InputError("synth." + key_, "must be an integer");
    }
    number = static_cast<Number>(value_);
  }

  std::string key_;
  double value_;
  std::string prefix_;
  std::vector<std::string> known_;
  bool found_ = false;
};

}  // namespace

synth::SynthRequest with_number(synth::SynthRequest request, const std::string& key, double value) {
  if (!(std::abs(value) <= kMaxMagnitude))
    throw InputError("synth." + key, "must be a finite number below 1e9");
  NumberSetter setter(key, value);
  visit_fields(setter, request);
  if (!setter.found()) {
    throw InputError("unknown rendering parameter \"synth." + key + "\"" + suggestion(key, setter.known()));
  }
  synth::check_request(request);
  return request;
}

namespace {

namespace fs = std::filesystem;

bool is_glob(const std::string& pattern) { return pattern.find_first_of("*?[") != std::string::npos; }

bool matches(const std::string& pattern, const std::string& name) {
  return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

/// Recorded sequences by name. Registered ones take precedence over folders of the same name.
std::map<std::string, RegisteredSequence> known_sequences() {
  std::map<std::string, RegisteredSequence> known;
  for (const RegisteredSequence& sequence : read_registry(registry_file())) known[sequence.name] = sequence;
  std::error_code ignored;
  if (!fs::is_directory(data_folder(), ignored)) return known;
  for (const fs::directory_entry& entry : fs::directory_iterator(data_folder())) {
    const std::string name = entry.path().filename().string();
    if (datasets::is_sequence_path(entry.path()))
      known.insert({name, {.name = name, .folder = entry.path(), .checksum = "", .format = ""}});
  }
  return known;
}

/// The sequence of a registration, after reading all its files to verify the checksum.
/// @throws InputError if the folder does not exist, or its files have changed since the registration
PlanSequence verified_sequence(const RegisteredSequence& registered) {
  if (!datasets::is_sequence_path(registered.folder)) {
    throw InputError("sequence \"" + registered.name + "\"",
                     "its folder " + registered.folder.string() +
                         " does not exist; restore it, or register it again with `stillpoint data add`");
  }
  const std::string checksum = sequence_checksum(registered.folder);
  if (!registered.checksum.empty() && registered.checksum != checksum) {
    throw InputError("sequence \"" + registered.name + "\"",
                     "the checksum of its files is " + checksum + ", expected " + registered.checksum +
                         " as registered; restore them, or register them again with `stillpoint data add`");
  }
  return {.name = registered.name,
          .id = checksum,
          .rendering = {},
          .folder = registered.folder,
          .unavailable_reason = ""};
}

/// Whether a pattern of [recorded] is a path; names of sequences have no slash.
bool is_path(const std::string& pattern) { return pattern.find('/') != std::string::npos; }

/// A folder or bag that is named by its path; relative to the working directory.
RegisteredSequence sequence_at(const std::string& path) {
  std::error_code error;
  const fs::path folder = fs::canonical(path, error);
  if (error || !datasets::is_sequence_path(folder)) {
    throw InputError("sequence \"" + path + "\"",
                     "is neither a folder nor a bag; correct the path, or register the sequence "
                     "with `stillpoint data add NAME DIR`");
  }
  return {.name = folder.filename().string(), .folder = folder, .checksum = "", .format = ""};
}

/// The patterns, with names of the catalogue ("tum/fr3_walking_*") replaced by those of their registrations.
std::vector<std::string> without_catalogue_names(const std::vector<std::string>& patterns,
                                                 const std::vector<datasets::CatalogueDataset>& catalogues) {
  std::vector<std::string> names;
  for (const std::string& pattern : patterns) {
    const std::vector<datasets::CatalogueEntry> entries = datasets::matching_entries(catalogues, pattern);
    std::error_code ignored;
    if (!is_path(pattern) || entries.empty() || fs::is_directory(pattern, ignored)) {
      names.push_back(pattern);
      continue;
    }
    for (const datasets::CatalogueEntry& entry : entries)
      names.push_back(datasets::registered_name(*entry.dataset, *entry.sequence));
  }
  return names;
}

/// The sequences that a pattern selects; empty if none.
std::vector<RegisteredSequence> selected_by(const std::string& pattern,
                                            const std::map<std::string, RegisteredSequence>& known) {
  if (is_path(pattern) && !is_glob(pattern)) return {sequence_at(pattern)};
  std::vector<RegisteredSequence> selected;
  for (const auto& [name, sequence] : known) {
    if (matches(pattern, name)) selected.push_back(sequence);
  }
  return selected;
}

/// Adds a sequence unless it is already in the list, e.g. because two globs match it.
/// @throws InputError for another folder of the same name, as tables identify sequences by their names
void add_distinct(std::vector<PlanSequence>& found, const RegisteredSequence& sequence) {
  const auto same_name = std::ranges::find(found, sequence.name, &PlanSequence::name);
  if (same_name == found.end()) {
    found.push_back(verified_sequence(sequence));
    return;
  }
  std::error_code ignored;
  if (!fs::equivalent(same_name->folder, sequence.folder, ignored)) {
    throw InputError("sequence \"" + sequence.name + "\"",
                     "is the name of two folders, " + same_name->folder.string() + " and " +
                         sequence.folder.string() +
                         "; register one under another name with `stillpoint data add NAME DIR`");
  }
}

[[noreturn]] void throw_unknown(const std::string& pattern, const std::string& advice,
                                const std::map<std::string, RegisteredSequence>& known) {
  if (!advice.empty()) throw InputError("sequence \"" + pattern + "\"", "is not available; " + advice);
  std::vector<std::string> names;
  names.reserve(known.size());
  for (const auto& [name, sequence] : known) names.push_back(name);
  throw InputError("sequence \"" + pattern + "\"",
                   "is neither registered nor a folder in " + data_folder().string() +
                       suggestion(pattern, names) +
                       "; register it with `stillpoint data add NAME DIR`, or set STILLPOINT_DATA");
}

}  // namespace

fs::path data_folder() {
  const char* set = std::getenv("STILLPOINT_DATA");
  return set != nullptr ? fs::path(set) : fs::path("../shared/data");
}

std::vector<std::string> matching_presets(const std::vector<std::string>& patterns) {
  std::vector<std::string> found;
  const std::vector<std::string> presets = synth::preset_names();
  for (const std::string& pattern : patterns) {
    bool is_known = false;
    for (const std::string& name : presets) {
      if (!matches(pattern, name)) continue;
      is_known = true;
      if (std::ranges::find(found, name) == found.end()) found.push_back(name);
    }
    if (is_known) continue;
    throw InputError("sequence \"" + pattern + "\"", "matches no preset" + suggestion(pattern, presets));
  }
  return found;
}

PlanSequence rendered_sequence(const BenchPlan& plan, const std::string& preset, int seed,
                               const SweepAxis& axis) {
  synth::SynthRequest request = synth::preset_request(preset);
  if (plan.rendered.seconds > 0.0) request.seconds = plan.rendered.seconds;
  request.seed = static_cast<std::uint64_t>(seed);
  for (const SweepAxis& setting : plan.synth_settings) {
    request = with_number(request, setting.key, setting.values.front());
  }
  if (!axis.key.empty())
    request = with_number(request, axis.key.substr(kSynthPrefix.size()), axis.values.front());
  return {.name = preset,
          .id = synth::sequence_id(request),
          .rendering = request,
          .folder = {},
          .unavailable_reason = "",
          .frame_cache = plan.frame_cache};
}

std::vector<PlanSequence> recorded_sequences(const RecordedGroup& group) {
  std::vector<PlanSequence> found;
  const std::map<std::string, RegisteredSequence> known = known_sequences();
  const std::vector<datasets::CatalogueDataset> catalogues = load_catalogues();
  for (const std::string& pattern : without_catalogue_names(group.sequences, catalogues)) {
    const std::vector<RegisteredSequence> selected = selected_by(pattern, known);
    for (const RegisteredSequence& sequence : selected) add_distinct(found, sequence);
    if (!selected.empty()) continue;
    const std::string advice = fetch_advice(catalogues, pattern);
    if (group.required) throw_unknown(pattern, advice, known);
    if (is_glob(pattern)) continue;
    found.push_back(
        {.name = pattern,
         .id = "",
         .rendering = {},
         .folder = {},
         .unavailable_reason = !advice.empty()
                                   ? fmt::format("{}: {}", pattern, advice)
                                   : "no folder " + (data_folder() / pattern).string() +
                                         "; set STILLPOINT_DATA, or register it with `stillpoint data add`"});
  }
  return found;
}

fs::path sequence_folder(const PlanSequence& sequence, const synth::RenderControl& control) {
  if (sequence.rendering) {
    return rendered_sequence(*sequence.rendering, control,
                             sequence.frame_cache ? frame_cache_options(0, {}) : std::nullopt);
  }
  if (datasets::is_sequence_path(sequence.folder)) return sequence.folder;
  throw InputError(sequence.folder.string(),
                   "no longer exists; restore the sequence and run the command again");
}

namespace {

[[noreturn]] void throw_unresolved(const std::string& argument,
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
  std::string argument = datasets::is_sequence_path(given) ? given : without_catalogue_name(given);
  if (datasets::is_sequence_path(argument)) return argument;
  const std::vector<std::string> presets = synth::preset_names();
  const bool is_preset = std::ranges::find(presets, argument) != presets.end();
  const std::vector<RegisteredSequence> registry = read_registry(registry_file());
  const auto registered = std::ranges::find(registry, argument, &RegisteredSequence::name);
  if (registered == registry.end()) {
    if (!is_preset) throw_unresolved(argument, registry);
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
