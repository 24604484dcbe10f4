// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/hosts.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "bench/process/child_process.h"
#include "bench/process/temporary_path.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kNotStarted = 127;
constexpr int kSignalCode = 128;

}  // namespace

ToolResult call_tool(const ToolCall& call) {
  const TemporaryPath capture(TemporaryPath::Kind::kFile, "output");
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

namespace {

constexpr int kMaxTasks = 1000;

bool is_host(const std::string& name) {
  const std::size_t at = name.find('@');
  if (at == std::string::npos) return is_host_word(name);
  return is_host_word(name.substr(0, at)) && is_host_word(name.substr(at + 1));
}

int task_count(const std::string& text) {
  int count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  const bool is_number = error == std::errc{} && end == text.data() + text.size();
  if (!is_number || count < 1 || count > kMaxTasks)
    throw InputError("tasks \"" + text + "\" must be a number from 1 to " + std::to_string(kMaxTasks));
  return count;
}

/// The host with one more word of its line.
Host with_word(Host host, const std::string& word) {
  const std::size_t equals = word.find('=');
  const std::string key = word.substr(0, equals);
  const std::string value = equals == std::string::npos ? "" : word.substr(equals + 1);
  if (key == "program" || key == "package") {
    if (!value.starts_with('/') || !is_plain_word(value))
      throw InputError(key + " \"" + value +
                       "\" must be an absolute path of letters, digits and _ . / + , = @ : -");
    (key == "program" ? host.program : host.package) = value;
  } else if (key == "class") {
    if (!is_host_word(value))
      throw InputError("class \"" + value + "\" must consist of letters, digits and _ . -");
    host.machine_class = value;
  } else if (key == "tasks") {
    host.tasks = task_count(value);
  } else {
    throw InputError("unknown word \"" + word +
                     "\"; expected program=PATH, package=FILE, class=NAME or tasks=N");
  }
  return host;
}

Host parse_host(std::istringstream& words, const std::string& name, const std::string& program) {
  if (!is_host(name))
    throw InputError("host \"" + name +
                     "\" must be NAME or USER@NAME of letters, digits and _ . -; "
                     "port and keys belong into the configuration of ssh");
  Host host{.name = name, .program = program, .package = "", .machine_class = ""};
  for (std::string word; words >> word;) host = with_word(std::move(host), word);
  if (!host.package.empty() && host.program != program)
    throw InputError("program=PATH and package=FILE exclude each other");
  if (host.package.empty() && !is_plain_word(host.program))
    throw InputError("the path of this program, " + host.program +
                     ", has characters that shells interpret; add program=PATH");
  return host;
}

}  // namespace

bool is_host_word(std::string_view text) {
  const auto is_letter = [](char letter) {
    const auto code = static_cast<unsigned char>(letter);
    return code < 0x80 && std::isalnum(code) != 0;
  };
  const auto is_allowed = [&](char letter) {
    return is_letter(letter) || std::string_view("_.-").find(letter) != std::string_view::npos;
  };
  return !text.empty() && is_letter(text.front()) && std::ranges::all_of(text, is_allowed);
}

std::vector<Host> parse_hosts(std::string_view text, const std::string& place, const fs::path& program) {
  std::vector<Host> hosts;
  eval::LineReader lines(text);
  for (long number = 1; const auto line = lines.next(); ++number) {
    std::istringstream words{std::string(line->substr(0, line->find('#')))};
    std::string name;
    if (!(words >> name)) continue;
    try {
      hosts.push_back(parse_host(words, name, program.string()));
    } catch (const InputError& error) {
      throw InputError(place, number, error.what());
    }
    if (std::ranges::count(hosts, name, &Host::name) > 1)
      throw InputError(place, number, "host \"" + name + "\" is listed twice; use tasks=N for more tasks");
  }
  if (hosts.empty()) throw InputError(place, "lists no host; write one per line");
  return hosts;
}

namespace {

constexpr std::size_t kBlockBytes = 1 << 20;

std::uint64_t file_hash(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw InputError(file.string(), "cannot be read; write it with scripts/image.sh or scripts/package.sh");
  std::string block(kBlockBytes, '\0');
  std::uint64_t hash = 0;
  while (stream.read(block.data(), kBlockBytes) || stream.gcount() > 0)
    hash = content_hash({block.data(), static_cast<std::size_t>(stream.gcount())}, hash);
  return hash;
}

ToolCall extraction(const fs::path& file, const fs::path& tree) {
  if (file.extension() == ".deb") return {.program = "dpkg-deb", .arguments = {"--extract", file, tree}};
  return {.program = "tar",
          .arguments = {"--extract", "--zstd", "--no-same-owner", "--file", file, "--directory", tree}};
}

}  // namespace

HostPackage extract_package(const fs::path& file, const fs::path& folder,
                            const std::function<bool()>& stop_requested) {
  const bool is_deb = file.extension() == ".deb";
  if (!is_deb && !file.string().ends_with(".tar.zst"))
    throw InputError(file.string(), "is neither a Debian package (.deb) nor a root file system (.tar.zst)");
  HostPackage package{.tree = {},
                      .name = hash_text(file_hash(file)),
                      .program = is_deb ? "usr/bin/stillpoint" : "stillpoint"};
  package.tree = folder / package.name;
  if (fs::exists(package.tree)) return package;
  const fs::path incomplete = folder / (package.name + ".incomplete");
  fs::remove_all(incomplete);
  fs::create_directories(incomplete);
  ToolCall call = extraction(file, incomplete);
  call.stop_requested = stop_requested;
  const ToolResult result = call_tool(call);
  if (stop_requested && stop_requested()) return package;
  if (result.exit_code != 0) throw InputError(file.string(), "cannot be extracted: " + result.messages);
  if (!fs::exists(incomplete / package.program))
    throw InputError(file.string(),
                     "lacks /" + package.program + "; write it with scripts/image.sh or scripts/package.sh");
  fs::rename(incomplete, package.tree);
  return package;
}

}  // namespace stillpoint::bench
