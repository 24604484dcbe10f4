// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/bench_plan.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/config/config_file.h"
#include "bench/config/key_effects.h"
#include "bench/config/settings.h"
#include "bench/config/spelling.h"
#include "bench/config/toml_source.h"
#include "bench/model/metrics.h"
#include "bench/plan/plan_sequences.h"
#include "bench/run/odometry_run.h"
#include "bench/systems/external_run.h"
#include "bench/systems/external_system.h"
#include "bench/systems/published_table.h"
#include "datasets/faults/sensor_fault.h"
#include "eval/protocols/protocol.h"

namespace stillpoint::bench {
namespace {

constexpr std::string_view kConfigPrefix = "config.";
constexpr std::string_view kSweepPrefix = "sweep.";

std::string toml_text(const SettingValue& value) {
  struct Printer {
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(std::int64_t number) const { return fmt::format("{}", number); }
    std::string operator()(double number) const { return fmt::format("{}", number); }
    std::string operator()(const std::string& text) const { return toml_quoted(text); }
    std::string operator()(const std::vector<std::string>& texts) const {
      std::vector<std::string> elements;
      elements.reserve(texts.size());
      for (const std::string& text : texts) elements.push_back(toml_quoted(text));
      return fmt::format("[{}]", fmt::join(elements, ", "));
    }
    std::string operator()(const std::vector<double>& numbers) const {
      return fmt::format("[{}]", fmt::join(numbers, ", "));
    }
  };
  return std::visit(Printer{}, value);
}

double number_of(const Setting& setting) {
  if (const auto* whole = std::get_if<std::int64_t>(&setting.value)) return static_cast<double>(*whole);
  if (const auto* number = std::get_if<double>(&setting.value)) return *number;
  throw InputError(setting.file, setting.line, "\"" + setting.key + "\" must be a number");
}

SweepAxis axis_of(const Setting& setting) {
  const auto* values = std::get_if<std::vector<double>>(&setting.value);
  if (values == nullptr) {
    throw InputError(setting.file, setting.line,
                     "\"" + setting.key + "\" must be a list of numbers, e.g. [0.0, 0.1, 0.3]");
  }
  return {.key = setting.key.substr(kSweepPrefix.size()), .values = *values};
}

/// Parses a plan; the settings of the tables [config], [synth] and [sweep] are not those of the plan itself.
BenchPlan parse_plan(const std::vector<Setting>& settings) {
  BenchPlan plan;
  std::vector<Setting> own_settings;
  for (const Setting& setting : settings) {
    const std::string& key = setting.key;
    if (key.starts_with(kConfigPrefix)) {
      plan.config_settings.push_back(key.substr(kConfigPrefix.size()) + "=" + toml_text(setting.value));
    } else if (key.starts_with(kSynthPrefix)) {
      plan.synth_settings.push_back({key.substr(kSynthPrefix.size()), {number_of(setting)}});
    } else if (key.starts_with(kSweepPrefix)) {
      plan.sweep.push_back(axis_of(setting));
    } else {
      own_settings.push_back(setting);
    }
  }
  return with_settings(std::move(plan), own_settings);
}

int parse_processor(std::string_view text, const std::string& cores) {
  int number = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = error == std::errc{} && end == text.data() + text.size();
  if (!is_number || number < 0 || number >= sysconf(_SC_NPROCESSORS_CONF)) {
    throw InputError("cores \"" + cores + "\"",
                     fmt::format("\"{}\" is not a processor of this machine; expected 0 to {}", text,
                                 sysconf(_SC_NPROCESSORS_CONF) - 1));
  }
  return number;
}

/// The file in the folder of the plan, if it is there, else in the working folder.
/// @throws InputError if it is in neither
std::string file_of_plan(const std::string& file, const BenchPlan& plan) {
  namespace fs = std::filesystem;
  if (const auto known = plan.files.find(file); known != plan.files.end()) return known->second;
  const fs::path beside = (fs::path(plan.path).parent_path() / file).lexically_normal();
  std::error_code ignored;
  if (fs::exists(beside, ignored)) return beside.string();
  if (fs::exists(file, ignored)) return file;
  throw InputError(file, "is neither in the folder of the plan nor in the working folder; correct the path");
}

/// A recorded sequence: a name, or the path of a folder in the folder of the plan, if it is there, else in
/// the working folder.
std::string sequence_of_plan(const std::string& name, const BenchPlan& plan) {
  namespace fs = std::filesystem;
  if (const auto known = plan.files.find(name); known != plan.files.end()) return known->second;
  const fs::path folder = fs::path(plan.path).parent_path();
  std::error_code ignored;
  const bool is_beside =
      name.find('/') != std::string::npos && !folder.empty() && fs::exists(folder / name, ignored);
  return is_beside ? (folder / name).string() : name;
}

/// Records where the plan finds its configs and sequences.
void record_files(BenchPlan& plan) {
  std::vector<std::string> configs = plan.variants;
  for (const auto* group : {&plan.rendered.variants, &plan.recorded.variants})
    configs.insert(configs.end(), group->begin(), group->end());
  configs.push_back(plan.base);
  for (const std::string& config : configs) {
    std::istringstream parts(config);
    for (std::string part; std::getline(parts, part, '+');) {
      if (part.ends_with(".toml")) plan.files[part] = file_of_plan(part, plan);
    }
  }
  for (std::string& sequence : plan.recorded.sequences) {
    const std::string found = sequence_of_plan(sequence, plan);
    if (sequence.find('/') != std::string::npos) plan.files[sequence] = found;
    sequence = found;
  }
}

/// Resolves the published tables that are files, and records where they are.
void find_published(BenchPlan& plan) {
  for (std::string& table : plan.table.published) {
    if (!table.ends_with(".toml")) continue;
    const std::string found = file_of_plan(table, plan);
    plan.files[table] = found;
    table = found;
  }
}

}  // namespace

std::string config_of_plan(const BenchPlan& plan, const std::string& name) {
  std::vector<std::string> parts;
  std::istringstream names(name);
  for (std::string part; std::getline(names, part, '+');)
    parts.push_back(part.ends_with(".toml") ? file_of_plan(part, plan) : part);
  return fmt::format("{}", fmt::join(parts, "+"));
}

std::vector<int> parse_cpu_list(const std::string& cores) {
  std::vector<int> processors;
  for (std::string_view rest = cores; !rest.empty();) {
    const std::string_view part = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(rest.size(), part.size() + 1));
    const std::size_t dash = part.find('-');
    const int first = parse_processor(part.substr(0, dash), cores);
    const int last = dash == std::string_view::npos ? first : parse_processor(part.substr(dash + 1), cores);
    for (int processor = first; processor <= last; ++processor) processors.push_back(processor);
  }
  return processors;
}

namespace {

constexpr double kMaxWhole = 9e15;  // below 2^53: exact as an integer

/// @param place of the setting in the plan, for messages
void require_setting(Setting setting, const std::string& place) {
  setting.file = place;
  setting.line = 0;
  static_cast<void>(with_settings(OdometryConfig{}, std::vector{setting}));
}

/// Whether a sweep varies this odometry: neither the scene nor a parameter of an external system.
bool is_config_key(const std::string& key) {
  return !key.starts_with(kSynthPrefix) && !key.starts_with(kParamPrefix);
}

/// Sweep values are numbers; whole ones are accepted by keys that require an integer.
SettingValue sweep_value(double value) {
  const bool is_whole = value == std::floor(value) && std::abs(value) <= kMaxWhole;
  return is_whole ? SettingValue(static_cast<std::int64_t>(value)) : SettingValue(value);
}

/// Checks the keys and values of [config] and [sweep]; both are independent of the variants.
void require_settings(const BenchPlan& plan) {
  for (const std::string& assignment : plan.config_settings) {
    const std::string key = "config." + assignment.substr(0, assignment.find('='));
    require_setting(at_place(plan, key, [&] { return parse_assignment(assignment); }), place_of(plan, key));
  }
  for (const SweepAxis& axis : plan.sweep) {
    if (!is_config_key(axis.key)) continue;
    for (const double value : axis.values)
      require_setting({.key = axis.key, .value = sweep_value(value)}, place_of(plan, "sweep." + axis.key));
  }
}

/// The config of a variant of the plan with further settings.
OdometryConfig config_of(const BenchPlan& plan, const std::string& variant,
                         const std::vector<std::string>& settings) {
  return load_config({config_of_plan(plan, plan.base), config_of_plan(plan, variant), settings});
}

/// @param key of the list in the plan
void require_configs(const BenchPlan& plan, const std::string& key,
                     const std::vector<std::string>& variants) {
  at_place(plan, key, [&] {
    for (const std::string& variant : variants) static_cast<void>(config_of(plan, variant, {}));
  });
}

/// Runs that differ in a key without effect are equal, unlike what the table says.
void require_effect(const BenchPlan& plan, const std::string& key, const std::string& table) {
  std::vector<std::string> variants = plan.variants;
  for (const auto* group : {&plan.rendered.variants, &plan.recorded.variants})
    variants.insert(variants.end(), group->begin(), group->end());
  std::string_view requirement;
  for (const std::string& variant : variants) {
    requirement = missing_requirement(key, config_of(plan, variant, plan.config_settings));
    if (requirement.empty()) return;
  }
  if (variants.empty()) return;
  throw InputError(place_of(plan, table + "." + key),
                   fmt::format("\"{}\" has no effect in any variant; it requires {}", key, requirement));
}

void require_effects(const BenchPlan& plan) {
  for (const std::string& assignment : plan.config_settings)
    require_effect(plan, assignment.substr(0, assignment.find('=')), "config");
  for (const SweepAxis& axis : plan.sweep) {
    if (is_config_key(axis.key)) require_effect(plan, axis.key, "sweep");
  }
}

void require_renderings(const BenchPlan& plan) {
  synth::SynthRequest request;
  for (const SweepAxis& setting : plan.synth_settings) {
    request = at_place(plan, std::string(kSynthPrefix) + setting.key,
                       [&] { return with_number(request, setting.key, setting.values.front()); });
  }
  for (const SweepAxis& axis : plan.sweep) {
    if (!axis.key.starts_with(kSynthPrefix)) continue;
    at_place(plan, "sweep." + axis.key, [&] {
      for (const double value : axis.values)
        static_cast<void>(with_number(request, axis.key.substr(kSynthPrefix.size()), value));
    });
  }
}

void require_protocols(const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const eval::Protocol& protocol : eval::protocols()) known.emplace_back(protocol.name);
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw InputError("unknown protocol \"" + name + "\"" + suggestion(name, known));
  }
}

void require_mode(const BenchPlan& plan) {
  if (std::ranges::find(kRunModes, plan.mode) != kRunModes.end()) return;
  throw InputError(place_of(plan, "mode"), fmt::format("\"mode\" is \"{}\"; expected one of: \"{}\"",
                                                       plan.mode, fmt::join(kRunModes, "\", \"")));
}

/// A description: a name, or a file as `file_of_plan`.
std::string description_of_plan(const std::string& name, const BenchPlan& plan) {
  const std::string file = parse_system_name(name).file;
  return file.ends_with(".toml") ? file_of_plan(file, plan) + name.substr(file.size()) : name;
}

std::vector<std::string> descriptions_of(const BenchPlan& plan) {
  std::vector<std::string> names;
  for (const std::string& name : plan.systems) names.push_back(description_of_plan(name, plan));
  return names;
}

/// The systems of the plan, and what they can do.
void require_systems(const BenchPlan& plan) {
  std::vector<ExternalSystem> systems;
  at_place(plan, "systems", [&] {
    for (const std::string& name : plan.systems) systems.push_back(load_external_system(name));
  });
  if (!systems.empty() && plan.kind == RunKind::kInstructions)
    throw InputError(place_of(plan, "systems"),
                     "kind = \"instructions\" does not support external systems; remove systems");
  const bool is_changed =
      plan.max_frames > 0 ||
      std::ranges::any_of(plan.faults, [](const std::string& fault) { return fault != kNoFault; });
  for (const ExternalSystem& system : systems) {
    const bool is_paced = std::ranges::any_of(
        system.command, [](const std::string& word) { return word.find("{speed}") != std::string::npos; });
    if (plan.mode == "realtime" && !is_paced)
      throw InputError(
          place_of(plan, "mode"),
          "system \"" + system.name +
              "\" does not read its input at the rate of the sensors; its command needs {speed}, "
              "e.g. of `stillpoint data play {sequence} --speed {speed}`");
    if (is_changed && system.layout == ExportLayout::kAsIs)
      throw InputError(place_of(plan, plan.max_frames > 0 ? "max_frames" : "faults"),
                       "system \"" + system.name +
                           "\" reads the recorded files (layout = \"as_is\"), which are "
                           "not changed; use layout = \"tum\" or \"euroc\"");
  }
  for (const SweepAxis& axis : plan.sweep) {
    if (!axis.key.starts_with(kParamPrefix)) continue;
    const std::string name = axis.key.substr(kParamPrefix.size());
    if (std::ranges::none_of(systems, [&](const ExternalSystem& s) { return s.param.contains(name); }))
      throw InputError(place_of(plan, "sweep." + axis.key), "no system of the plan has the parameter \"" +
                                                                name + "\"; add it to its table [param]");
  }
}

void require_faults(const BenchPlan& plan) {
  for (const std::string& fault : plan.faults) {
    if (fault == kNoFault) continue;
    static_cast<void>(datasets::parse_fault(fault));
    if (!plan.systems.empty() && !reaches_external_systems(fault))
      throw InputError("\"" + fault +
                       "\" does not reach external systems: an exported sequence has neither the "
                       "arrival of frames nor recorded boxes; remove it, or systems");
  }
}

void require_expectations(const BenchPlan& plan) {
  if (plan.expected.empty()) return;
  if (plan.expected.size() != plan.faults.size())
    throw InputError(fmt::format("has {} values for {} faults; give one for each", plan.expected.size(),
                                 plan.faults.size()));
  for (const std::string& value : plan.expected) {
    if (value != kExpectSurvival && value != kExpectLoss)
      throw InputError(fmt::format("unknown value \"{}\"; expected \"survive\" or \"lose\"", value));
  }
}

/// Runs with equal keys are executed once; a value that is listed twice would only look like a repetition.
template <class Value>
void require_distinct(const BenchPlan& plan, const std::string& key, const std::vector<Value>& values) {
  for (auto value = values.begin(); value != values.end(); ++value) {
    if (std::find(values.begin(), value, *value) == value) continue;
    throw InputError(place_of(plan, key), fmt::format("\"{}\" contains {} twice; remove one{}", key, *value,
                                                      key == "seeds" ? ", or set repetitions = 2" : ""));
  }
}

void require_distinct_lists(const BenchPlan& plan) {
  require_distinct(plan, "seeds", plan.seeds);
  require_distinct(plan, "variants", plan.variants);
  require_distinct(plan, "rendered.variants", plan.rendered.variants);
  require_distinct(plan, "recorded.variants", plan.recorded.variants);
  require_distinct(plan, "systems", plan.systems);
  require_distinct(plan, "faults", plan.faults);
  require_distinct(plan, "protocols", plan.protocols);
  for (const SweepAxis& axis : plan.sweep) require_distinct(plan, "sweep." + axis.key, axis.values);
}

void require_ablation_base(const BenchPlan& plan) {
  std::vector<std::string> known = plan.variants;
  for (const auto* variants : {&plan.rendered.variants, &plan.recorded.variants})
    known.insert(known.end(), variants->begin(), variants->end());
  for (const std::string& system : plan.systems) known.push_back(load_external_system(system).variant);
  const std::string& base = plan.ablation_base;
  if (base.empty() || std::find(known.begin(), known.end(), base) != known.end()) return;
  throw InputError("ablation_base \"" + base + "\" is no variant of the plan" + suggestion(base, known));
}

void validate_plan(const BenchPlan& plan) {
  static_cast<void>(at_place(plan, "base", [&] { return config_of(plan, "", {}); }));
  require_settings(plan);
  require_configs(plan, "variants", plan.variants);
  require_configs(plan, "rendered.variants", plan.rendered.variants);
  require_configs(plan, "recorded.variants", plan.recorded.variants);
  require_effects(plan);
  require_renderings(plan);
  require_distinct_lists(plan);
  require_mode(plan);
  at_place(plan, "faults", [&] { require_faults(plan); });
  at_place(plan, "expected", [&] { require_expectations(plan); });
  at_place(plan, "protocols", [&] { require_protocols(plan.protocols); });
  at_place(plan, "cores", [&] { static_cast<void>(parse_cpu_list(plan.cores)); });
  at_place(plan, "rendered.sequences", [&] { static_cast<void>(matching_presets(plan.rendered.sequences)); });
  require_systems(plan);
  at_place(plan, "ablation_base", [&] { require_ablation_base(plan); });
  at_place(plan, "table.published", [&] {
    for (const std::string& name : plan.table.published) {
      const std::string metric = load_published(name).metric;
      if (metric != "mean_ms" && find_metric(without_protocol(metric)) == nullptr)
        throw InputError(name,
                         "\"metric\" is \"" + metric + "\", which no run has; see the ids in result.json");
    }
  });
}

}  // namespace

BenchPlan load_plan(const std::string& name, const std::vector<std::string>& systems,
                    std::map<std::string, std::string> files) {
  const TomlSource source = find_toml(name, TomlKind::kPlan);
  const std::vector<Setting> settings = parse_settings(source.text, source.path);
  BenchPlan plan = parse_plan(settings);
  plan.name = std::filesystem::path(source.path).stem().string();
  plan.path = source.path;
  for (const Setting& setting : settings)
    plan.places[setting.key] = fmt::format("{}:{}", setting.file, setting.line);
  plan.text = source.text;
  if (plan.title.empty()) plan.title = plan.name;
  plan.systems = systems.empty() ? at_place(plan, "systems", [&] { return descriptions_of(plan); }) : systems;
  plan.files = std::move(files);
  at_place(plan, "table.published", [&] { find_published(plan); });
  validate_plan(plan);
  record_files(plan);
  return plan;
}

namespace {

/// A sweep over something that the plan does not run has no run, and settings of it change nothing.
void require_varied(const BenchPlan& plan) {
  const auto has_own = [&plan](const std::vector<std::string>& sequences,
                               const std::vector<std::string>& variants) {
    return !sequences.empty() && !(plan.variants.empty() && variants.empty());
  };
  const bool is_rendered = !plan.rendered.sequences.empty();
  const bool is_own = has_own(plan.rendered.sequences, plan.rendered.variants) ||
                      has_own(plan.recorded.sequences, plan.recorded.variants);
  const auto reject = [&plan](const std::string& place, const std::string& problem) {
    throw InputError(place_of(plan, place), "\"" + place + "\" " + problem);
  };
  constexpr const char* kOfScene = "changes rendered sequences, and the plan has none; add [rendered]";
  for (const SweepAxis& axis : plan.sweep) {
    if (axis.key.starts_with(kSynthPrefix) && !is_rendered) reject("sweep." + axis.key, kOfScene);
    if (is_config_key(axis.key) && !is_own)
      reject("sweep." + axis.key, "changes this odometry, and the plan has no variant of it; add variants");
  }
  for (const SweepAxis& setting : plan.synth_settings) {
    if (!is_rendered) reject(std::string(kSynthPrefix) + setting.key, kOfScene);
  }
}

}  // namespace

void require_runs(const BenchPlan& plan) {
  const auto require_group = [&plan](const std::string& group, const std::vector<std::string>& sequences,
                                     const std::vector<std::string>& variants) {
    if (sequences.empty() || !variants.empty() || !plan.variants.empty() || !plan.systems.empty()) return;
    throw InputError(place_of(plan, plan.places.contains("variants") ? "variants" : group + ".sequences"),
                     "the plan has no variant and no system to run; add e.g. variants = [\"stillpoint\"]");
  };
  if (plan.rendered.sequences.empty() && plan.recorded.sequences.empty()) {
    throw InputError(plan.path,
                     "the plan names no sequence; add e.g. [rendered] with "
                     "sequences = [\"walking_xyz\"]");
  }
  if (plan.seeds.empty())
    throw InputError(place_of(plan, "seeds"), "the list of seeds is empty; add seeds = [1]");
  require_group("rendered", plan.rendered.sequences, plan.rendered.variants);
  require_group("recorded", plan.recorded.sequences, plan.recorded.variants);
  require_varied(plan);
}

namespace {

bool contains(std::span<const std::string> names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The longest variant that `variant` extends by overlays, else `base`.
std::string base_of(const std::string& variant, const std::string& base,
                    std::span<const std::string> variants) {
  for (std::size_t plus = variant.rfind('+'); plus != std::string::npos && plus > 0;
       plus = variant.rfind('+', plus - 1)) {
    if (contains(variants, variant.substr(0, plus))) return variant.substr(0, plus);
  }
  return base;
}

}  // namespace

std::optional<std::string> ablation_base_of(const StoredPlan& plan) {
  try {
    for (const Setting& setting : parse_settings(plan.text, "plan " + plan.name)) {
      const auto* base = std::get_if<std::string>(&setting.value);
      if (setting.key == "ablation_base" && base != nullptr && !base->empty()) return *base;
    }
  } catch (const InputError&) {
    return std::nullopt;  // written by hand or by another version; the runs are valid without it
  }
  return std::nullopt;
}

std::vector<AblationGroup> ablation_groups(const std::string& base, std::span<const std::string> variants) {
  if (!contains(variants, base)) return {};
  std::vector<AblationGroup> groups = {{.base = base, .variants = {}}};
  for (const std::string& variant : variants) {
    if (variant == base) continue;
    const std::string own = base_of(variant, base, variants);
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const AblationGroup& known) { return known.base == own; });
    if (group == groups.end()) group = groups.insert(groups.end(), {.base = own, .variants = {}});
    group->variants.push_back(variant);
  }
  std::erase_if(groups, [](const AblationGroup& group) { return group.variants.empty(); });
  return groups;
}

}  // namespace stillpoint::bench
