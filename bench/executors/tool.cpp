// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/tool.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <string_view>

#include <fmt/format.h>
#include <unistd.h>

#include "bench/process/process_pool.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kNotStarted = 127;
constexpr int kSignalCode = 128;

/// A temporary file, removed with the object.
class OutputCapture {
 public:
  OutputCapture() {
    std::string name = (fs::temp_directory_path() / "stillpoint-output-XXXXXX").string();
    const int file = mkstemp(name.data());
    if (file < 0)
      throw InputError(name, std::string("cannot be created: ") + std::strerror(errno) + "; set TMPDIR");
    close(file);
    path_ = name;
  }
  ~OutputCapture() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  OutputCapture(const OutputCapture&) = delete;
  OutputCapture& operator=(const OutputCapture&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

ToolResult call_tool(const ToolCall& call) {
  const OutputCapture capture;
  ProcessPool pool(call.stop_requested);
  pool.start(0, {.program = call.program, .arguments = call.arguments, .output = capture.path()});
  const ProcessResult process = pool.wait_next()->second;
  ToolResult result{.exit_code = process.signal != 0 ? kSignalCode + process.signal : process.exit_code,
                    .output = eval::read_text_file(capture.path()),
                    .messages = last_line(process.messages)};
  if (result.exit_code == kNotStarted && result.messages == "cannot be started")
    throw InputError(call.program, "is not installed; see scripts/setup.sh --all for the packages");
  return result;
}

std::string require_tool(const ToolCall& call) {
  ToolResult result = call_tool(call);
  if (result.exit_code == 0) return std::move(result.output);
  throw InputError(call.program, fmt::format("exited with code {}: {}", result.exit_code, result.messages));
}

bool is_plain_word(const std::string& word) {
  constexpr std::string_view kMarks = "_./+,=@:-";
  const auto is_plain = [&](char letter) {
    const auto code = static_cast<unsigned char>(letter);
    return (code < 0x80 && std::isalnum(code) != 0) || kMarks.find(letter) != std::string_view::npos;
  };
  return !word.empty() && word.front() != '-' && std::ranges::all_of(word, is_plain);
}

}  // namespace stillpoint::bench
