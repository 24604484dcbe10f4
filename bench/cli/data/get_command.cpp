// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/data/fetch_progress.h"
#include "bench/cli/interrupt.h"
#include "bench/config/spelling.h"
#include "bench/fetch/fetch_sequences.h"
#include "bench/plan/bench_plan.h"
#include "bench/plan/dataset_catalogue.h"
#include "core/base/error.h"
#include "datasets/cache/cache_space.h"

namespace stillpoint::bench {
namespace {

struct GetArguments {
  std::vector<std::string> sequences;
  std::string plan;
  std::string to;
  std::string mirror;
  bool accept_licence = false;
  bool keep_archives = false;
  int attempts = 5;
  int stall_timeout_s = 30;
  double backoff_s = 1.0;
};

/// The sequences of a plan that the catalogue has.
std::vector<std::string> patterns_of_plan(const std::string& plan,
                                          const std::vector<datasets::CatalogueDataset>& catalogues) {
  std::vector<std::string> patterns;
  for (const std::string& pattern : load_plan(plan).recorded.sequences) {
    if (!datasets::matching_entries(catalogues, pattern).empty()) patterns.push_back(pattern);
  }
  if (patterns.empty()) throw InputError("--for " + plan, "this plan has no sequences of the catalogue");
  return patterns;
}

std::vector<datasets::CatalogueEntry> selected_entries(
    const GetArguments& arguments, const std::vector<datasets::CatalogueDataset>& catalogues) {
  std::vector<std::string> patterns = arguments.sequences;
  if (!arguments.plan.empty()) patterns = patterns_of_plan(arguments.plan, catalogues);
  if (patterns.empty()) throw InputError("data get", "requires the name of a sequence, or --for PLAN");
  std::vector<datasets::CatalogueEntry> entries;
  for (const std::string& pattern : patterns) {
    const std::vector<datasets::CatalogueEntry> found = datasets::matching_entries(catalogues, pattern);
    if (found.empty()) {
      std::vector<std::string> names;
      for (const datasets::CatalogueDataset& dataset : catalogues) {
        for (const datasets::CatalogueSequence& sequence : dataset.sequences)
          names.push_back(datasets::catalogue_name(dataset, sequence));
      }
      throw InputError("sequence \"" + pattern + "\"",
                       "is not in the catalogue" + suggestion(pattern, names) +
                           "; `stillpoint data catalogue` lists the datasets");
    }
    for (const datasets::CatalogueEntry& entry : found) {
      const bool is_new = std::ranges::none_of(
          entries, [&](const datasets::CatalogueEntry& known) { return known.sequence == entry.sequence; });
      if (is_new) entries.push_back(entry);
    }
  }
  return entries;
}

/// One line about what will be downloaded.
void print_selection(const std::vector<datasets::CatalogueEntry>& entries,
                     const std::filesystem::path& root) {
  std::size_t available = 0;
  std::set<std::string> counted;
  std::uint64_t bytes = 0;
  bool has_unknown = false;
  for (const datasets::CatalogueEntry& entry : entries) {
    if (is_available(*entry.dataset, *entry.sequence)) {
      ++available;
      continue;
    }
    for (const std::string& file : entry.sequence->archives) {
      if (!counted.insert(entry.dataset->name + "/" + file).second) continue;
      const std::uint64_t size = datasets::archive_of(*entry.dataset, file).bytes;
      bytes += size;
      has_unknown = has_unknown || size == 0;
    }
  }
  std::cout << fmt::format("{} sequences, {} available; {} archives to download to {}", entries.size(),
                           available, counted.size(), root.string());
  if (bytes > 0) std::cout << (has_unknown ? ", more than " : ", ") << datasets::size_text(bytes);
  std::cout << "\n" << std::flush;
}

int get(const GetArguments& arguments) {
  install_interrupt_handlers();
  const std::vector<datasets::CatalogueDataset> catalogues = load_catalogues();
  const std::vector<datasets::CatalogueEntry> entries = selected_entries(arguments, catalogues);
  FetchOptions options{.root = arguments.to.empty() ? download_root() : std::filesystem::path(arguments.to),
                       .mirror = arguments.mirror,
                       .keep_archives = arguments.keep_archives,
                       .attempts = arguments.attempts,
                       .first_backoff_s = arguments.backoff_s,
                       .stall_timeout_s = arguments.stall_timeout_s,
                       .limits = {}};
  if (const char* mirror = std::getenv("STILLPOINT_MIRROR"); options.mirror.empty() && mirror != nullptr)
    options.mirror = mirror;
  accept_licences(entries, options.root, arguments.accept_licence);
  print_selection(entries, options.root);
  FetchProgress progress;
  if (!fetch_sequences(entries, options, progress.control())) {
    std::cout << "interrupted; run the command again to continue\n";
    return kExitInterrupted;
  }
  std::cout << fmt::format("{} sequences are available\n", entries.size());
  return kExitOk;
}

}  // namespace

Command get_command() {
  const auto arguments = std::make_shared<GetArguments>();
  return {
      .name = "get",
      .summary =
          "Download, verify, extract and register sequences of public datasets; continues after an "
          "interruption. Proxies and tokens are taken from the environment",
      .example = "data get tum/fr3_walking_xyz --accept-licence",
      .options =
          {{.name = "SEQ",
            .help = "Sequences, globs or groups: tum/fr3_walking_xyz, \"tum/fr3_*\", openloris/cafe",
            .target = &arguments->sequences,
            .may_be_omitted = true},
           {"--for", "Plan whose missing sequences are fetched", &arguments->plan},
           {"--to", "Folder of downloads [$STILLPOINT_DATA, else ~/.local/share/stillpoint]", &arguments->to},
           {"--mirror", "Address that serves ADDRESS/DATASET/FILE, tried first [$STILLPOINT_MIRROR]",
            &arguments->mirror},
           {"--accept-licence", "Accept the licences of the datasets; they are printed",
            &arguments->accept_licence},
           {"--keep-archives", "Keep the archives after extraction", &arguments->keep_archives},
           {"--attempts", "Attempts per address without progress [5]", &arguments->attempts, {1, 1000}},
           {"--stall-timeout",
            "Seconds below 1 kB/s after which an attempt ends [30]",
            &arguments->stall_timeout_s,
            {1, 100000}},
           {"--backoff",
            "Seconds before the second attempt; doubled for each further one [1]",
            &arguments->backoff_s,
            {0, 3600}}},
      .action = [arguments] { return get(*arguments); }};
}

}  // namespace stillpoint::bench
