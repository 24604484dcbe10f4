// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/bench_plan.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "bench/config/apply_settings.h"
#include "bench/config/config_text.h"
#include "bench/config/toml_source.h"
#include "bench/plan/plan_validation.h"
#include "bench/plan/synth_settings.h"
#include "core/base/error.h"

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

}  // namespace

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

BenchPlan load_plan(const std::string& name) {
  const TomlSource source = find_toml(name, TomlKind::kPlan);
  const std::vector<Setting> settings = parse_settings(source.text, source.path);
  BenchPlan plan = parse_plan(settings);
  plan.name = std::filesystem::path(source.path).stem().string();
  plan.path = source.path;
  for (const Setting& setting : settings)
    plan.places[setting.key] = fmt::format("{}:{}", setting.file, setting.line);
  plan.text = source.text;
  if (plan.title.empty()) plan.title = plan.name;
  validate_plan(plan);
  return plan;
}

}  // namespace stillpoint::bench
