// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/callgrind_file.h"

#include <charconv>

#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

std::string_view cut_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

/// Parses lines in order; tracks the current function.
class CallgrindReader {
 public:
  explicit CallgrindReader(const std::string& place) : place_(place) {}

  void take(std::string_view line) {
    ++line_;
    if (line.starts_with("fn=")) {
      function_ = &counts_.self[name(line.substr(3))];
    } else if (line.starts_with("cfn=")) {
      called_ = name(line.substr(4));
    } else if (line.starts_with("calls=")) {
      after_calls_ = true;
    } else if (line.starts_with("events:")) {
      require(line == "events: Ir", "contains other events than \"Ir\"");
      has_events_ = true;
    } else if (line.starts_with("totals:")) {
      counts_.total = number(line.substr(line.find_last_of(' ') + 1));
    } else if (!line.empty() && is_cost(line.front())) {
      take_cost(number(line.substr(line.find_last_of(' ') + 1)));
    }
  }

  CallgrindCounts finish() && {
    require(has_events_ && counts_.total > 0, "has no counts; did the program exit normally?");
    return std::move(counts_);
  }

 private:
  /// Position lines begin with a line number, absolute ("12"), relative ("+3", "-3") or equal ("*").
  static bool is_cost(char first) {
    return (first >= '0' && first <= '9') || first == '+' || first == '-' || first == '*';
  }

  void take_cost(std::int64_t cost) {
    if (after_calls_) {
      counts_.inclusive[called_] += cost;
      after_calls_ = false;
    } else {
      require(function_ != nullptr, "has a count outside of a function");
      *function_ += cost;
    }
  }

  /// Name compression: "(3) name" defines the id "(3)", later lines use the id alone.
  std::string name(std::string_view text) {
    if (!text.starts_with('(')) return std::string(text);
    const std::size_t end = text.find(')');
    require(end != std::string_view::npos, "has a name with an unterminated id");
    const std::string id(text.substr(0, end + 1));
    if (text.size() > end + 2) names_[id] = text.substr(end + 2);
    const auto found = names_.find(id);
    require(found != names_.end(), "uses an undefined name id");
    return found->second;
  }

  [[nodiscard]] std::int64_t number(std::string_view text) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    require(error == std::errc{} && end == text.data() + text.size(), "has an invalid count");
    return value;
  }

  void require(bool condition, const char* problem) const {
    if (!condition) throw InputError(place_, line_, std::string(problem) + "; expected callgrind output");
  }

  const std::string& place_;
  long line_ = 0;
  CallgrindCounts counts_;
  std::map<std::string, std::string> names_;
  std::int64_t* function_ = nullptr;  ///< self count of the current function
  std::string called_;
  bool after_calls_ = false;  ///< the next count belongs to the call
  bool has_events_ = false;
};

}  // namespace

CallgrindCounts parse_callgrind(std::string_view text, const std::string& place) {
  CallgrindReader reader(place);
  while (!text.empty()) reader.take(cut_line(text));
  return std::move(reader).finish();
}

}  // namespace stillpoint::bench
