// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/data/fetch_progress.h"
#include "bench/cli/interrupt.h"
#include "bench/config/spelling.h"
#include "bench/fetch/fetch_sequences.h"
#include "bench/plan/dataset_catalogue.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

struct GetArguments {
  std::vector<std::string> sequences;
  std::string plan;
  std::string to;
  std::string mirror;
  bool accept_licence = false;
  bool keep_archives = false;
  bool boxes = false;
  int attempts = 5;
  int stall_timeout_s = 30;
  double backoff_s = 1.0;
};

std::vector<datasets::CatalogueEntry> selected_entries(
    const GetArguments& arguments, const std::vector<datasets::CatalogueDataset>& catalogues) {
  if (!arguments.plan.empty()) return plan_entries(arguments.plan, catalogues);
  if (arguments.sequences.empty())
    throw InputError("data get", "requires the name of a sequence, or --for PLAN");
  std::vector<datasets::CatalogueEntry> entries;
  for (const std::string& pattern : arguments.sequences) {
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

int get(const GetArguments& arguments) {
  install_interrupt_handlers();
  const std::vector<datasets::CatalogueDataset> catalogues = load_catalogues();
  const std::vector<datasets::CatalogueEntry> entries = selected_entries(arguments, catalogues);
  const FetchOptions options{.root = arguments.to,
                             .mirror = arguments.mirror,
                             .keep_archives = arguments.keep_archives,
                             .attempts = arguments.attempts,
                             .first_backoff_s = arguments.backoff_s,
                             .stall_timeout_s = arguments.stall_timeout_s,
                             .limits = {},
                             .record_boxes = arguments.boxes};
  const LicenceAnswer licence = arguments.accept_licence ? LicenceAnswer::kAccepted : LicenceAnswer::kAsk;
  const FetchResult result = fetch_with_progress(entries, options, licence);
  if (result.stopped) return kExitInterrupted;
  if (result.problems.size() == 1) throw InputError(result.problems.front());
  if (!result.problems.empty()) {
    throw InputError(fmt::format("{} downloads failed:\n  {}", result.problems.size(),
                                 fmt::join(result.problems, "\n  ")));
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
           {"--boxes", "Also download a detection network, and record its boxes in new sequences",
            &arguments->boxes},
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
