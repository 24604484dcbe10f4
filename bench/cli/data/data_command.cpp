// SPDX-License-Identifier: BSD-3-Clause
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/plan/plan_sequences.h"
#include "bench/plan/sequence_registry.h"
#include "bench/record/sequence_checksum.h"
#include "bench/run/frame_cache.h"
#include "bench/run/sequence_source.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "datasets/cache/cache_space.h"
#include "datasets/open_sequence.h"
#include "datasets/sequence_export.h"
#include "datasets/synthetic/sequence/presets.h"
#include "eval/io/text_reader.h"
#include "reports/tables/data_table.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

std::string utc_text(fs::file_time_type time) {
  const auto seconds =
      std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::file_clock::to_sys(time));
  return fmt::format("{:%Y-%m-%d %H:%M:%S}", seconds);
}

int print_files() {
  report::DataTable table{.kind = "data_cache",
                          .columns = {"sequence", "frames", "bytes", "last_used", "file"},
                          .rows = {},
                          .notes = {}};
  for (const datasets::CacheEntry& entry : datasets::list_cache(frame_cache_folder())) {
    table.rows.push_back({report::data_value(entry.sequence), report::data_value(entry.frames),
                          static_cast<std::int64_t>(entry.bytes), utc_text(entry.last_used),
                          entry.file.filename().string()});
  }
  std::cout << report::data_json(table);
  return kExitOk;
}

int list_files() {
  for (const datasets::CacheEntry& entry : datasets::list_cache(frame_cache_folder())) {
    std::cout << fmt::format("{:<24} {:>6} frames {:>8}  {}  {}\n",
                             entry.sequence.empty() ? "(damaged)" : entry.sequence, entry.frames,
                             datasets::size_text(entry.bytes), utc_text(entry.last_used),
                             entry.file.filename().string());
  }
  return kExitOk;
}

struct CacheSizeArguments {
  std::string limit;
};

int show_size(const CacheSizeArguments& arguments) {
  const fs::path folder = frame_cache_folder();
  if (!arguments.limit.empty()) {
    store_frame_cache_limit(folder, datasets::size_from_text("--limit", arguments.limit));
  }
  std::cout << fmt::format(
      "{} of {} in {}, disk reserve {}\n  {}\n", datasets::size_text(datasets::cache_bytes(folder)),
      datasets::size_text(frame_cache_limit(folder)), counted(datasets::list_cache(folder).size(), "file"),
      datasets::size_text(datasets::kDefaultDiskReserveBytes), folder.string());
  return kExitOk;
}

struct CachePruneArguments {
  std::string size;
};

int prune(const CachePruneArguments& arguments) {
  const fs::path folder = frame_cache_folder();
  const std::uint64_t limit =
      arguments.size.empty() ? frame_cache_limit(folder) : datasets::size_from_text("--size", arguments.size);
  const std::uint64_t removed = datasets::prune_cache(folder, limit);
  std::cout << fmt::format("removed {}, {} remain\n", datasets::size_text(removed),
                           datasets::size_text(datasets::cache_bytes(folder)));
  return kExitOk;
}

Command cache_list_command() {
  const auto json = std::make_shared<bool>(false);
  return {.name = "list",
          .summary = "List the sequences with decoded frames, the least recently used first; times in UTC",
          .example = "data cache list",
          .options = {{"--json", report::kJsonHelp, json.get()}},
          .action = [json] { return *json ? print_files() : list_files(); }};
}

Command cache_size_command() {
  const auto arguments = std::make_shared<CacheSizeArguments>();
  return {.name = "size",
          .summary = "Show the used space and its limit",
          .example = "data cache size --limit 50G",
          .options = {{"--limit", "Store this limit for all later runs, e.g. 50G; 0 = no frame cache",
                       &arguments->limit}},
          .action = [arguments] { return show_size(*arguments); }};
}

Command cache_prune_command() {
  const auto arguments = std::make_shared<CachePruneArguments>();
  return {.name = "prune",
          .summary = "Remove the least recently used files, and what interrupted runs left",
          .example = "data cache prune --size 5G",
          .options = {{"--size", "Size that may remain, e.g. 5G or 0 [the limit]", &arguments->size}},
          .action = [arguments] { return prune(*arguments); }};
}

}  // namespace

Command cache_command() {
  return {
      .name = "cache",
      .summary = "Manage the decoded frames that runs keep; limit: $STILLPOINT_CACHE_SIZE or `size --limit`",
      .example = "data cache list",
      .subcommands = {cache_list_command(), cache_size_command(), cache_prune_command()}};
}

namespace {

struct ExportArguments {
  std::string sequence;
  std::string out;
  std::string layout = "bag";
  std::string compression = "none";
  std::string format;
  std::string rig;
  std::vector<std::string> topics;
};

void write(const datasets::SensorStream& stream, const ExportArguments& arguments,
           const datasets::ExportControl& control) {
  if (arguments.layout == "tum") {
    datasets::export_tum(stream, arguments.out, control);
  } else if (arguments.layout == "euroc") {
    datasets::export_euroc(stream, arguments.out, control);
  } else {
    datasets::export_bag(stream, arguments.out, arguments.compression, control);
  }
}

int export_sequence(const ExportArguments& arguments) {
  if (arguments.layout != "tum" && arguments.layout != "euroc" && arguments.layout != "bag")
    throw InputError("--layout", "\"" + arguments.layout + "\" is unknown; expected one of: tum, euroc, bag");
  if (arguments.out.empty()) throw InputError("--out", "is required: the output folder or bag");
  if (std::filesystem::exists(arguments.out))
    throw InputError("--out", arguments.out + " exists; choose another name or remove it");
  install_interrupt_handlers();
  const std::unique_ptr<datasets::SensorStream> stream =
      find_sequence(resolve_sequence(arguments.sequence),
                    {.format = arguments.format, .rig_file = arguments.rig, .topics = arguments.topics},
                    {.stop_requested = interrupt_requested});
  if (!stream) return kExitInterrupted;
  const std::filesystem::path parent = std::filesystem::absolute(arguments.out).parent_path();
  std::filesystem::create_directories(parent);
  {
    ProgressLine line("exporting " + stream->info().name, stream->info().frame_times.size(), "frames");
    const datasets::ExportControl control{
        .progress = [&line](std::size_t done, std::size_t) { line.update(done); },
        .stop_requested = interrupt_requested};
    write(*stream, arguments, control);
  }
  std::cout << arguments.out << '\n';
  return kExitOk;
}

}  // namespace

Command export_command() {
  const auto arguments = std::make_shared<ExportArguments>();
  return {
      .name = "export",
      .summary = "Write a sequence of any format in another layout, for other systems",
      .example = "data export my_sequence --layout bag --out my_sequence.bag",
      .options =
          {{"SEQ", "Sequence folder, bag or preset name", &arguments->sequence},
           {"--layout",
            "Output layout: tum, euroc, or bag (--out FILE.bag for ROS 1, FILE.mcap, or a folder of rosbag2)",
            &arguments->layout},
           {"--out", "Output folder or bag; must not exist", &arguments->out},
           {"--compression", "Of a bag: none, bz2 (ROS 1), lz4 (ROS 1, MCAP) or zstd (MCAP)",
            &arguments->compression},
           {"--format", "Format of the input [detected]", &arguments->format},
           {"--rig", kRigHelp, &arguments->rig},
           {"--topics", kTopicsHelp, &arguments->topics}},
      .action = [arguments] { return export_sequence(*arguments); }};
}

namespace {

struct AddArguments {
  std::string name;
  std::string folder;
  bool force = false;
};

/// `run` could not tell the sequence from the rendering.
void require_no_preset(const std::string& name) {
  const std::vector<std::string> presets = synth::preset_names();
  if (std::ranges::find(presets, name) == presets.end()) return;
  throw InputError("sequence name \"" + name + "\"",
                   "is that of a rendered sequence; choose another name, such as recorded_" + name);
}

int add(const AddArguments& arguments) {
  require_no_preset(arguments.name);
  const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(arguments.folder);
  const RegisteredSequence sequence{.name = arguments.name,
                                    .folder = std::filesystem::canonical(arguments.folder),
                                    .checksum = sequence_checksum(arguments.folder),
                                    .format = stream->info().format};
  for (const std::string& warning : stream->info().warnings) spdlog::warn("{}", warning);
  if (stream->info().detections.empty())
    spdlog::info(
        "no recorded boxes (detections.txt); `stillpoint detect` records them, but changes the checksum");
  register_sequence(registry_file(), sequence, arguments.force ? Registration::kReplace : Registration::kNew);
  std::cout << fmt::format("registered {}: {} ({}, {}, checksum {})\n", sequence.name,
                           sequence.folder.string(), sequence.format,
                           counted(stream->info().frame_times.size(), "frame"), sequence.checksum);
  return kExitOk;
}

int print_registry() {
  report::DataTable table{.kind = "data_list",
                          .columns = {"name", "format", "checksum", "folder", "available"},
                          .rows = {},
                          .notes = {}};
  for (const RegisteredSequence& sequence : read_registry(registry_file())) {
    table.rows.push_back({sequence.name, sequence.format, sequence.checksum, sequence.folder.string(),
                          datasets::is_sequence_path(sequence.folder)});
  }
  std::cout << report::data_json(table);
  return kExitOk;
}

/// Whether each registered sequence can be used, and the folders of the data folder, which need no
/// registration.
int list() {
  const std::vector<RegisteredSequence> registry = read_registry(registry_file());
  for (const RegisteredSequence& sequence : registry) {
    std::cout << fmt::format("{:<32} {:<10} {}  {}{}\n", sequence.name, sequence.format, sequence.checksum,
                             sequence.folder.string(),
                             datasets::is_sequence_path(sequence.folder) ? "" : "  (missing)");
  }
  std::cout << fmt::format(
      "{} registered sequences; plans can also use the folders in {} by their names, and any folder by its "
      "path\n",
      registry.size(), data_folder().string());
  return kExitOk;
}

Command add_command() {
  const auto arguments = std::make_shared<AddArguments>();
  return {
      .name = "add",
      .summary = "Register a recorded sequence under a name for plans; stores its current checksum",
      .example = "data add cafe1 /data/openloris/cafe1-1",
      .options = {{"NAME", "Name of the sequence in plans", &arguments->name},
                  {"DIR", "Sequence folder or bag", &arguments->folder},
                  {"--force", "Replace the registration of the name for another folder", &arguments->force}},
      .action = [arguments] { return add(*arguments); }};
}

Command list_command() {
  const auto json = std::make_shared<bool>(false);
  return {.name = "list",
          .summary = "List the sequences that plans can use",
          .example = "data list",
          .options = {{"--json", report::kJsonHelp, json.get()}},
          .action = [json] { return *json ? print_registry() : list(); }};
}

/// A row of a list of images or of inertial samples.
struct PlayedRow {
  Timestamp t;
  std::string text;  ///< its kind, and the row
};

/// Appends the rows of a file, if it exists.
void add_rows(std::vector<PlayedRow>& rows, const fs::path& folder, const std::string& kind) {
  const fs::path file = folder / (kind + ".txt");
  if (!fs::exists(file)) return;
  const std::string text = eval::read_text_file(file);
  eval::LineReader lines(text);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (line->empty() || line->front() == '#') continue;
    const std::optional<Timestamp> t = eval::parse_stamp(line->substr(0, line->find_first_of(" \t,")));
    if (!t) throw InputError(file.string(), lines.line_number(), "does not begin with a time stamp [s]");
    rows.push_back({*t, kind + " " + std::string(*line)});
  }
}

/// Prints the rows of a folder in the layout "tum" in temporal order, each at its time.
/// @param speed 0: at once
int play(const std::string& folder, double speed) {
  std::vector<PlayedRow> rows;
  for (const char* const kind : {"imu", "depth", "rgb"}) add_rows(rows, folder, kind);
  if (rows.empty())
    throw InputError(folder, "has no rgb.txt, depth.txt or imu.txt; write it by `stillpoint data export`");
  std::ranges::stable_sort(rows, {}, &PlayedRow::t);
  install_interrupt_handlers();
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto elapsed_s = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  constexpr double kLongestWait_s = 0.1;  // an interruption ends it
  for (const PlayedRow& row : rows) {
    const double due_s = speed > 0.0 ? seconds_between(rows.front().t, row.t) / speed : 0.0;
    for (double rest_s = due_s - elapsed_s(); rest_s > 0.0 && !interrupt_requested();
         rest_s = due_s - elapsed_s())
      poll(nullptr, 0, static_cast<int>(std::ceil(1e3 * std::min(rest_s, kLongestWait_s))));
    if (interrupt_requested()) return kExitInterrupted;
    std::cout << row.text << '\n';
    if (speed > 0.0) std::cout.flush();
    if (!std::cout) return kExitFindings;  // the pipe was closed
  }
  return kExitOk;
}

Command play_command() {
  const auto folder = std::make_shared<std::string>();
  const auto speed = std::make_shared<double>(1.0);
  return {.name = "play",
          .summary = "Print the rows of an exported sequence at the rate of its sensors, for other programs",
          .example = "data play build/walking_xyz --speed 1 | ./my_slam",
          .options = {{"DIR", "Folder with rgb.txt, depth.txt and imu.txt, as of data export", folder.get()},
                      {"--speed", "1: as recorded; 0: at once [1]", speed.get(), {0, 1e3}}},
          .action = [folder, speed] { return play(*folder, *speed); }};
}

}  // namespace

Command data_command() {
  return {.name = "data",
          .summary = "Download, create and inspect sequences",
          .example = "data synth walking_xyz --out build/walking_xyz",
          .subcommands = {catalogue_command(), get_command(), verify_command(), list_command(), add_command(),
                          check_command(), synth_command(), export_command(), cache_command(),
                          cloud_command(), faults_command(), play_command()}};
}

}  // namespace stillpoint::bench
