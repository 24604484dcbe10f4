// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/bench_plan.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "bench/config/apply_settings.h"
#include "bench/config/config_file.h"
#include "bench/config/spelling.h"
#include "bench/config/toml_source.h"
#include "bench/plan/synth_settings.h"
#include "bench/systems/published_table.h"
#include "core/base/error.h"
#include "eval/protocols/protocol.h"

namespace stillpoint::bench {
namespace {

constexpr std::string_view kConfigPrefix = "config.";
constexpr std::string_view kSynthPrefix = "synth.";
constexpr std::string_view kSweepPrefix = "sweep.";

std::string toml_text(const SettingValue& value) {
  struct Printer {
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(std::int64_t number) const { return fmt::format("{}", number); }
    std::string operator()(double number) const { return fmt::format("{}", number); }
    std::string operator()(const std::string& text) const { return "\"" + text + "\""; }
    std::string operator()(const std::vector<std::string>&) const { return "[]"; }
    std::string operator()(const std::vector<double>&) const { return "[]"; }
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

/// Loads every config once, so that errors are reported before the first run.
void require_configs(const BenchPlan& plan, const std::vector<std::string>& variants) {
  for (const std::string& variant : variants) {
    static_cast<void>(load_config({plan.base, variant, plan.config_settings}));
    for (const SweepAxis& axis : plan.sweep) {
      if (axis.key.starts_with(kSynthPrefix)) continue;
      for (const double value : axis.values) {
        std::vector<std::string> settings = plan.config_settings;
        settings.push_back(fmt::format("{}={}", axis.key, value));
        static_cast<void>(load_config({plan.base, variant, settings}));
      }
    }
  }
}

void require_renderings(const BenchPlan& plan) {
  synth::SynthRequest request;
  for (const SweepAxis& setting : plan.synth_settings) {
    request = with_number(request, setting.key, setting.values.front());
  }
  for (const SweepAxis& axis : plan.sweep) {
    if (!axis.key.starts_with(kSynthPrefix)) continue;
    for (const double value : axis.values) {
      static_cast<void>(with_number(request, axis.key.substr(kSynthPrefix.size()), value));
    }
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

/// External systems always process whole sequences, and cannot run under callgrind.
void require_supported_by_systems(const BenchPlan& plan) {
  if (plan.systems.empty() || (plan.max_frames == 0 && plan.kind != RunKind::kInstructions)) return;
  throw InputError("plan \"" + plan.name + "\"",
                   "max_frames and kind = \"instructions\" do not support external systems; remove systems");
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
  BenchPlan plan = parse_plan(parse_settings(source.text, source.path));
  plan.name = std::filesystem::path(source.path).stem().string();
  plan.text = source.text;
  if (plan.title.empty()) plan.title = plan.name;
  require_configs(plan, plan.variants);
  require_configs(plan, plan.rendered.variants);
  require_configs(plan, plan.recorded.variants);
  require_renderings(plan);
  require_supported_by_systems(plan);
  require_protocols(plan.protocols);
  static_cast<void>(parse_cpu_list(plan.cores));
  for (const std::string& table : plan.table.published) static_cast<void>(load_published(table));
  return plan;
}

}  // namespace stillpoint::bench
