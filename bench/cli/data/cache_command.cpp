// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <iostream>
#include <memory>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/run/frame_cache_settings.h"
#include "datasets/cache/cache_space.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

std::string utc_text(fs::file_time_type time) {
  const auto seconds =
      std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::file_clock::to_sys(time));
  return fmt::format("{:%Y-%m-%d %H:%M:%S}", seconds);
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
      "{} of {} in {} files, disk reserve {}\n  {}\n", datasets::size_text(datasets::cache_bytes(folder)),
      datasets::size_text(frame_cache_limit(folder)), datasets::list_cache(folder).size(),
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
  return {.name = "list",
          .summary = "List the sequences with decoded frames, the least recently used first; times in UTC",
          .example = "data cache list",
          .action = list_files};
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

}  // namespace stillpoint::bench
