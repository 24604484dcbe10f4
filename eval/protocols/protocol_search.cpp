// SPDX-License-Identifier: BSD-3-Clause
#include "eval/protocols/protocol_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/base/error.h"
#include "eval/protocols/protocol.h"

namespace stillpoint::eval {
namespace {

/// An interval of relative errors that publications use.
struct RpeInterval {
  double delta;
  RpeUnit unit;
};
constexpr std::array<RpeInterval, 7> kIntervals = {{{1.0, RpeUnit::kSeconds},
                                                    {0.1, RpeUnit::kSeconds},
                                                    {1.0, RpeUnit::kFrames},
                                                    {10.0, RpeUnit::kFrames},
                                                    {30.0, RpeUnit::kFrames},
                                                    {1.0, RpeUnit::kMeters},
                                                    {10.0, RpeUnit::kMeters}}};

/// Largest differences of associated stamps [s]; the first is that of the protocol.
constexpr std::array<std::optional<double>, 4> kMaxDifferences = {std::nullopt, 0.01, 0.02, 0.1};

struct NamedStatistic {
  const char* name;
  double Statistics::*value;
};
constexpr std::array<NamedStatistic, 5> kStatistics = {{{"rmse", &Statistics::rmse},
                                                        {"mean", &Statistics::mean},
                                                        {"median", &Statistics::median},
                                                        {"std", &Statistics::std},
                                                        {"max", &Statistics::max}}};

template <class Enum>
std::string name_of(Enum wanted) {
  for (const auto& [value, name] : enum_names(wanted)) {
    if (value == wanted) return std::string(name);
  }
  return "";
}

std::string number_text(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

/// Collects the numbers of evaluations.
class NumberList {
 public:
  explicit NumberList(const PublishedNumber& number) : number_(number) {}

  void add_absolute(const Evaluation& evaluation, const std::string& options) {
    add(evaluation.ate_m, "ATE", "m", {evaluation, options});
    add(evaluation.ate_deg, "ATE", "deg", {evaluation, options});
  }

  void add_relative(const Evaluation& evaluation, const std::string& options) {
    const std::string name =
        "RPE over " + number_text(evaluation.rpe_delta) + " " + name_of(evaluation.rpe_unit) + ",";
    add(evaluation.rpe_m, name, "m", {evaluation, options});
    add(evaluation.rpe_deg, name, "deg", {evaluation, options});
  }

  std::vector<DefinedNumber> sorted() && {
    const auto rank = [this](const DefinedNumber& defined) {
      return std::pair(!defined.agrees, std::abs(defined.value - number_.value));
    };
    std::ranges::stable_sort(
        list_, [&](const DefinedNumber& a, const DefinedNumber& b) { return rank(a) < rank(b); });
    return std::move(list_);
  }

 private:
  struct Source {
    const Evaluation& evaluation;
    const std::string& options;
  };

  void add(const std::optional<Statistics>& errors, const std::string& name, const std::string& unit,
           const Source& source) {
    if (!errors) return;
    for (const NamedStatistic& statistic : kStatistics) {
      const double value = (*errors).*statistic.value;
      const std::string metric = name + " " + statistic.name + " " + unit;
      if (!std::isfinite(value) || !known_.insert({metric, value, errors->count}).second) continue;
      const double tolerance = number_.half_digit + 1e-9 * number_.value;
      list_.push_back({.metric = metric,
                       .protocol = source.evaluation.protocol,
                       .options = source.options,
                       .value = value,
                       .pairs = errors->count,
                       .agrees = std::abs(value - number_.value) <= tolerance});
    }
  }

  PublishedNumber number_;
  std::set<std::tuple<std::string, double, std::size_t>> known_;
  std::vector<DefinedNumber> list_;
};

/// @return nullopt for options that the protocol does not support, and data that it rejects
std::optional<Evaluation> evaluated(const Protocol& protocol, const EvaluationInput& input) {
  try {
    return evaluate(protocol.name, input);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// The strict protocols differ in their alignment, which is an option here.
bool is_repeated(const Protocol& protocol) {
  return protocol.name.starts_with("strict:") && protocol.name != "strict:se3";
}

std::string with_option(const std::string& options, const std::string& option) {
  return options.empty() ? option : options + " " + option;
}

}  // namespace

PublishedNumber parse_published(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const std::size_t exponent = std::min(text.find_first_of("eE"), text.size());
  const std::string mantissa = text.substr(0, exponent);
  const bool is_decimal = !mantissa.empty() && mantissa.find_first_not_of("0123456789.") == std::string::npos;
  if (end != text.c_str() + text.size() || !is_decimal || !std::isfinite(value) || value <= 0.0)
    throw InputError("\"" + text + "\"", "is no positive decimal number; write it as published, e.g. 0.0150");
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const std::size_t decimals = point == mantissa.size() ? 0 : mantissa.size() - point - 1;
  const double scale = exponent == text.size() ? 0.0 : std::strtod(text.c_str() + exponent + 1, nullptr);
  return {.value = value, .half_digit = 0.5 * std::pow(10.0, scale - static_cast<double>(decimals))};
}

std::vector<DefinedNumber> search_protocols(const Trajectory& gt, const Trajectory& est,
                                            const PublishedNumber& number) {
  NumberList numbers(number);
  for (const Protocol& protocol : protocols()) {
    if (is_repeated(protocol)) continue;
    for (const std::optional<double>& difference : kMaxDifferences) {
      ProtocolOptions options{.max_difference_s = difference, .per_pose = false};
      const std::string association = difference ? "--max-difference " + number_text(*difference) : "";
      for (const auto& [alignment, name] : enum_names(Alignment::kNone)) {
        options.alignment = alignment;
        const auto found = evaluated(protocol, {gt, est, options});
        const std::string text = with_option(association, "--align " + std::string(name));
        if (found) numbers.add_absolute(*found, alignment == Alignment::kSe3 ? association : text);
      }
      for (const Alignment alignment : {Alignment::kSe3, Alignment::kSim3}) {
        options.alignment = alignment;
        for (const RpeInterval& interval : kIntervals) {
          options.rpe_delta = interval.delta;
          options.rpe_unit = interval.unit;
          const auto found = evaluated(protocol, {gt, est, options});
          const std::string text = with_option(
              alignment == Alignment::kSe3 ? association : with_option(association, "--align sim3"),
              "--rpe-delta " + number_text(interval.delta) + " --rpe-unit " + name_of(interval.unit));
          if (found) numbers.add_relative(*found, text);
        }
      }
    }
  }
  return std::move(numbers).sorted();
}

}  // namespace stillpoint::eval
