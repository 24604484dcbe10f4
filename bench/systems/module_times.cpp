// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/module_times.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/config/spelling.h"
#include "bench/model/json_problem.h"
#include "bench/record/result_values.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Milliseconds = std::vector<double>;  // ms

constexpr std::string_view kColumnSuffix = "_ms";

double ms_per(TimingUnit unit) {
  switch (unit) {
    case TimingUnit::kSeconds:
      return 1e3;
    case TimingUnit::kMicroseconds:
      return 1e-3;
    case TimingUnit::kNanoseconds:
      return 1e-6;
    default:
      return 1.0;
  }
}

ModuleCost cost_of_calls(const std::string& module, const char* per, const Milliseconds& ms) {
  const eval::Statistics times = eval::statistics(ms).value_or(eval::Statistics{});
  return {.module = module,
          .per = per,
          .calls = static_cast<std::int64_t>(times.count),
          .mean_ms = times.mean,
          .median_ms = times.median,
          .p95_ms = eval::percentile(ms, 0.95).value_or(0.0),
          .max_ms = times.max};
}

void require_time(double ms, const std::string& place) {
  if (!std::isfinite(ms) || ms < 0.0)
    throw InputError(place, fmt::format("{} is no time; write a finite number of at least 0", ms));
}

// ---- JSON.

Milliseconds numbers_of(const Json& list, const std::string& place) {
  Milliseconds ms;
  for (const Json& number : list) {
    if (!number.is_number())
      throw InputError(place, number.dump(-1, ' ', false, Json::error_handler_t::replace) +
                                  " is no number; write milliseconds, one number per call");
    ms.push_back(number.get<double>());
    require_time(ms.back(), place);
  }
  return ms;
}

ModuleCost cost_of_json(const std::string& module, const char* per, const Json& time,
                        const std::string& place) {
  if (time.is_array()) return cost_of_calls(module, per, numbers_of(time, place));
  for (const char* const member : {"calls", "mean", "median", "p95", "max"}) {
    if (time.is_object() && time.contains(member) && time.at(member).is_number()) {
      require_time(time.at(member).get<double>(), place + "." + member);
      continue;
    }
    throw InputError(place,
                     fmt::format("has no number \"{}\"; write a list of milliseconds, one per call, or "
                                 "an object with calls, mean, median, p95 and max",
                                 member));
  }
  Json timings;
  timings[per == std::string_view("frame") ? "threads" : "modules"][module] = time;
  return module_costs(timings).front();
}

std::vector<ModuleCost> times_of_json(const std::string& text, const std::string& file) {
  constexpr const char* kRemedy =
      "write {\"modules\": {\"tracking\": [3.1, 2.9]}} with milliseconds, one per call, or add the table "
      "[timing] for lines of text";
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::exception& error) {
    throw InputError(file, "is no JSON: " + json_problem(error) + "; " + kRemedy);
  }
  if (json.is_object() && json.contains("timings")) json = Json(json.at("timings"));
  const auto has = [&json](const char* group) {
    return json.is_object() && json.contains(group) && json.at(group).is_object();
  };
  if (!has("modules") && !has("threads"))
    throw InputError(file, std::string("has no object \"modules\" or \"threads\"; ") + kRemedy);
  std::vector<ModuleCost> costs;
  for (const auto& [group, per] : {std::pair{"modules", "call"}, std::pair{"threads", "frame"}}) {
    if (!has(group)) continue;
    for (const auto& [module, time] : json.at(group).items())
      costs.push_back(cost_of_json(module, per, time, fmt::format("{}: {}.{}", file, group, module)));
  }
  return costs;
}

// ---- CSV.

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kAround = " \t\r\"";
  const std::size_t begin = std::min(text.find_first_not_of(kAround), text.size());
  text.remove_prefix(begin);
  return text.substr(0, text.find_last_not_of(kAround) + 1);
}

std::vector<std::string> split_cells(std::string_view line, char separator) {
  std::vector<std::string> cells;
  while (true) {
    const std::size_t end = std::min(line.find(separator), line.size());
    cells.emplace_back(trimmed(line.substr(0, end)));
    if (end == line.size()) return cells;
    line.remove_prefix(end + 1);
  }
}

char separator_of(std::string_view header) {
  for (const char separator : {';', ',', '\t'}) {
    if (header.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

/// Index of the column of each module.
std::map<std::string, std::size_t> time_columns(const ExternalSystem& system,
                                                const std::vector<std::string>& header,
                                                const std::string& place) {
  std::map<std::string, std::size_t> columns;
  for (const auto& [module, column] : system.timing) {
    const auto found = std::ranges::find(header, column);
    if (found == header.end())
      throw InputError(place, fmt::format("has no column \"{}\" of timing.{}; it has: {}{}", column, module,
                                          fmt::join(header, ", "), suggestion(column, header)));
    columns[module] = static_cast<std::size_t>(found - header.begin());
  }
  if (!system.timing.empty()) return columns;
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (header[i].size() > kColumnSuffix.size() && header[i].ends_with(kColumnSuffix))
      columns[header[i].substr(0, header[i].size() - kColumnSuffix.size())] = i;
  }
  if (columns.empty())
    throw InputError(place, fmt::format("has no column that ends in \"{}\", but: {}; name the columns by the "
                                        "table [timing]: MODULE = \"COLUMN\"",
                                        kColumnSuffix, fmt::join(header, ", ")));
  return columns;
}

std::map<std::string, Milliseconds> times_of_csv(const ExternalSystem& system, const std::string& text,
                                                 const std::string& file) {
  eval::LineReader lines(text);
  std::string_view header = lines.next().value_or("");
  if (header.starts_with('#')) header.remove_prefix(1);
  const char separator = separator_of(header);
  const std::map<std::string, std::size_t> columns =
      time_columns(system, split_cells(header, separator), file + ":1");
  std::map<std::string, Milliseconds> times;
  for (const auto& [module, unused] : columns) times[module] = {};
  while (const std::optional<std::string_view> line = lines.next()) {
    if (trimmed(*line).empty() || line->starts_with('#')) continue;
    const std::string place = fmt::format("{}:{}", file, lines.line_number());
    const std::vector<std::string> cells = split_cells(*line, separator);
    for (const auto& [module, column] : columns) {
      if (column >= cells.size())
        throw InputError(place, fmt::format("has {} cells, but timing.{} is in cell {}; write whole rows",
                                            cells.size(), module, column + 1));
      if (cells[column].empty()) continue;
      const std::optional<double> time = eval::parse_number(cells[column]);
      if (!time)
        throw InputError(place, fmt::format("timing.{}: \"{}\" is no number; write digits with a decimal "
                                            "point",
                                            module, cells[column]));
      require_time(*time, place + ": timing." + module);
      times[module].push_back(*time * ms_per(system.timing_unit));
    }
  }
  return times;
}

// ---- Lines of text.

std::map<std::string, Milliseconds> times_of_lines(const ExternalSystem& system, const std::string& text,
                                                   const std::string& file) {
  constexpr std::size_t kMaxLine = 4096;  // std::regex recurses over the characters of a line
  std::map<std::string, Milliseconds> times;
  for (const auto& [module, pattern] : system.timing) {
    const std::regex expression(pattern);
    Milliseconds& ms = times[module];
    eval::LineReader lines(text);
    while (const std::optional<std::string_view> line = lines.next()) {
      if (line->size() > kMaxLine) continue;
      using Matches = std::regex_iterator<std::string_view::const_iterator>;
      for (Matches match(line->begin(), line->end(), expression), end; match != end; ++match) {
        const std::string place = fmt::format("{}:{}: timing.{}", file, lines.line_number(), module);
        const std::optional<double> time = eval::parse_number(match->str(1));
        if (!time)
          throw InputError(place, fmt::format("\"{}\" is no number; write a group that matches a number only",
                                              match->str(1)));
        require_time(*time, place);
        ms.push_back(*time * ms_per(system.timing_unit));
      }
    }
    if (ms.empty())
      throw InputError(file, fmt::format("no line matches timing.{}: {}; correct the pattern, in which "
                                         "letters are case-sensitive",
                                         module, pattern));
  }
  return times;
}

}  // namespace

std::string pattern_problem(const std::string& pattern) {
  try {
    return std::regex(pattern).mark_count() == 1
               ? ""
               : "must have one group in parentheses, which is the time; write (?:...) for others";
  } catch (const std::regex_error& error) {
    return std::string("is no regular expression: ") + error.what() + "; write e.g. 'tracking: ([0-9.]+) ms'";
  }
}

std::string times_problem(const ExternalSystem& system, const fs::path& work, const ProcessResult& process) {
  try {
    static_cast<void>(read_module_times(system, work, process));
    return "";
  } catch (const InputError& error) {
    return std::string("times of its modules: ") + error.what();
  }
}

std::vector<ModuleCost> read_module_times(const ExternalSystem& system, const fs::path& work,
                                          const ProcessResult& process) {
  if (system.timings.empty() && system.timing.empty()) return {};
  if (system.timings.empty() && process.messages_incomplete)
    throw InputError("[timing]",
                     "the program printed more messages than are kept; let it write them to a "
                     "file in {out}, and set timings to that file");
  if (!system.timings.empty() && !fs::exists(work / system.timings))
    throw InputError(system.timings, "was not written; correct the key timings, or remove it");
  const std::string text =
      system.timings.empty() ? process.messages : eval::read_text_file(work / system.timings);
  const std::string file = system.timings.empty() ? "messages of the program" : system.timings;
  std::vector<ModuleCost> costs;
  const bool is_csv = is_timing_table(system);
  if (!is_csv && system.timing.empty()) {
    costs = times_of_json(text, file);
  } else {
    for (const auto& [module, ms] :
         is_csv ? times_of_csv(system, text, file) : times_of_lines(system, text, file))
      costs.push_back(cost_of_calls(module, "call", ms));
  }
  std::erase_if(costs, [](const ModuleCost& cost) { return cost.calls == 0; });
  return costs;
}

}  // namespace stillpoint::bench
