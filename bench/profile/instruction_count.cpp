// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/instruction_count.h"

#include <unistd.h>

#include <charconv>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "core/base/error.h"
#include "eval/io/text_reader.h"

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

namespace {

namespace fs = std::filesystem;

fs::path find_valgrind() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    fs::path file = fs::path(folder) / "valgrind";
    if (!folder.empty() && access(file.c_str(), X_OK) == 0) return file;
  }
  throw InputError("valgrind",
                   "is required to count instructions and is not in PATH; install the Debian package "
                   "\"valgrind\" (scripts/setup.sh --dev)");
}

/// Entry function of a stage, called once or twice per frame; its inclusive count is that of the stage.
struct StageFunction {
  const char* stage;
  std::string_view function;
};
constexpr StageFunction kStageFunctions[] = {
    {"tracking", "stillpoint::TrackingStage::process("},
    {"detection", "stillpoint::detect_objects("},
    {"optimization", "stillpoint::OptimizationStage::process("},
    {"optimization", "stillpoint::OptimizationStage::predict("},
};

/// Whether a callgrind name is that function, and not a part that the compiler split off.
bool is_function(std::string_view name, std::string_view function) {
  return name.starts_with(function) && name.find("[clone") == std::string_view::npos &&
         name.find(".part.") == std::string_view::npos && name.find(".cold") == std::string_view::npos;
}

/// Constant environment. Disables the threads of libraries where possible; otherwise every thread has its own
/// heap arena, and the per-thread cache of malloc is disabled.
std::vector<std::string> fixed_environment() {
  return {"PATH=/usr/bin:/bin", "LC_ALL=C", "OPENCV_FOR_THREADS_NUM=1", "OPENIMAGEIO_THREADS=1",
          "GLIBC_TUNABLES=glibc.malloc.tcache_count=0:glibc.malloc.arena_max=100"};
}

}  // namespace

ProcessSpec under_callgrind(ProcessSpec run, const fs::path& folder) {
  fs::create_directories(folder);
  std::vector<std::string> words = {"--quiet", "--tool=callgrind", "--fair-sched=yes",
                                    std::string("--callgrind-out-file=") + kCallgrindFile,
                                    run.program.string()};
  words.insert(words.end(), run.arguments.begin(), run.arguments.end());
  words.emplace_back("--deterministic-counts");
  run.program = find_valgrind();
  run.arguments = std::move(words);
  run.folder = folder;
  run.environment = fixed_environment();
  run.cores = {allowed_processors().front()};
  run.fixed_addresses = true;
  return run;
}

std::vector<StageInstructions> stage_instructions(const CallgrindCounts& counts, const std::string& place) {
  std::vector<StageInstructions> stages;
  for (const auto& [stage, function] : kStageFunctions) {
    if (stages.empty() || stages.back().stage != stage) stages.push_back({.stage = stage, .count = 0});
    for (const auto& [name, count] : counts.inclusive) {
      if (is_function(name, function)) stages.back().count += count;
    }
  }
  if (stages.front().count == 0) {
    throw InputError(place, "contains no stage of the odometry; is the binary stripped of its symbols?");
  }
  return stages;
}

std::vector<Metric> instruction_metrics(const std::vector<StageInstructions>& stages) {
  Measurements measurements;
  for (const auto& [stage, count] : stages) measurements.instructions[stage] = count;
  return measured_metrics(measurements);
}

std::vector<StageInstructions> read_instructions(const fs::path& folder) {
  const fs::path file = folder / kCallgrindFile;
  return stage_instructions(parse_callgrind(eval::read_text_file(file), file.string()), file.string());
}

}  // namespace stillpoint::bench
