// SPDX-License-Identifier: BSD-3-Clause
// Subcommands of `stillpoint data` on the catalogue of public datasets: catalogue, get, verify.
#include <fnmatch.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/cli/data/fetch_progress.h"
#include "bench/config/spelling.h"
#include "bench/fetch/data_lock.h"
#include "bench/fetch/fetch_sequences.h"
#include "bench/plan/sequence_registry.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "datasets/cache/cache_space.h"
#include "reports/tables/data_table.h"

namespace stillpoint::bench {
namespace {

using datasets::CatalogueArchive;
using datasets::CatalogueDataset;
using datasets::CatalogueEntry;
using datasets::CatalogueSequence;

std::size_t available_sequences(const CatalogueDataset& dataset) {
  return static_cast<std::size_t>(std::ranges::count_if(
      dataset.sequences, [&](const CatalogueSequence& sequence) { return is_available(dataset, sequence); }));
}

/// Published size of all archives.
struct PublishedSize {
  std::uint64_t bytes = 0;
  bool is_complete = true;  ///< whether the size of each is published
};

PublishedSize published_size(const CatalogueDataset& dataset) {
  PublishedSize size{.is_complete = !dataset.archives.empty()};
  for (const CatalogueArchive& archive : dataset.archives) {
    size.bytes += archive.bytes;
    size.is_complete = size.is_complete && archive.bytes > 0;
  }
  return size;
}

/// "?" if none is published.
std::string total_size(const CatalogueDataset& dataset) {
  const PublishedSize size = published_size(dataset);
  if (size.bytes == 0) return "?";
  return (size.is_complete ? "" : "> ") + datasets::size_text(size.bytes);
}

int list_datasets(const std::vector<CatalogueDataset>& catalogues) {
  std::cout << fmt::format("{:<16} {:>9} {:>9} {:>10}  {:<28} {}\n", "dataset", "sequences", "available",
                           "size", "licence", "title");
  for (const CatalogueDataset& dataset : catalogues) {
    std::string licence = dataset.licence;
    if (licence.size() > 28) licence = licence.substr(0, 25) + "...";
    std::cout << fmt::format("{:<16} {:>9} {:>9} {:>10}  {:<28} {}\n", dataset.name, dataset.sequences.size(),
                             available_sequences(dataset), total_size(dataset), licence, dataset.title);
  }
  std::cout << fmt::format("\nOwn catalogue files: {}/*.toml\n", user_catalogue_folder().string());
  return kExitOk;
}

std::string digest_kind(const CatalogueDataset& dataset, const CatalogueArchive& archive) {
  if (!archive.sha256.empty()) return "SHA-256";
  if (!archive.md5.empty()) return "MD5";
  return dataset.md5_suffix.empty() ? "first use" : "MD5 of the host";
}

void print_sequences(const CatalogueDataset& dataset) {
  std::cout << fmt::format("\n{:<44} {:<14} {:>10} {:<16} {}\n", "sequence", "group", "archive", "digest",
                           "");
  std::set<std::string> printed;
  for (const CatalogueSequence& sequence : dataset.sequences) {
    std::string size;
    std::string digest;
    for (const std::string& file : sequence.archives) {
      const CatalogueArchive& archive = datasets::archive_of(dataset, file);
      const bool is_first = printed.insert(file).second;
      const std::string bytes = archive.bytes == 0 ? "?" : datasets::size_text(archive.bytes);
      size += (size.empty() ? "" : "+") + (is_first ? bytes : "same");
      digest = digest_kind(dataset, archive);
    }
    std::cout << fmt::format("{:<44} {:<14} {:>10} {:<16} {}\n", catalogue_name(dataset, sequence),
                             sequence.group, size, digest,
                             is_available(dataset, sequence) ? "available" : "");
  }
}

int show_dataset(const CatalogueDataset& dataset) {
  std::cout << fmt::format("{}\n  {}\n  homepage: {}\n  licence: {}\n  layout: {}\n", dataset.name,
                           dataset.title, dataset.homepage, dataset.licence, dataset.layout);
  if (!dataset.token_variable.empty())
    std::cout << "  token: environment variable " << dataset.token_variable << "\n";
  for (const std::string& note : dataset.notes) std::cout << "  - " << note << "\n";
  if (!dataset.manual.empty()) std::cout << "  by hand: " << dataset.manual << "\n";
  print_sequences(dataset);
  std::cout << "\n" << dataset.citation << "\n";
  return kExitOk;
}

/// The datasets as a table for programs.
int print_datasets(const std::vector<CatalogueDataset>& catalogues) {
  report::DataTable table{.kind = "data_catalogue",
                          .columns = {"dataset", "title", "licence", "homepage", "layout", "sequences",
                                      "available", "bytes", "bytes_complete"},
                          .rows = {},
                          .notes = {}};
  for (const CatalogueDataset& dataset : catalogues) {
    const PublishedSize size = published_size(dataset);
    table.rows.push_back({dataset.name, dataset.title, dataset.licence, dataset.homepage, dataset.layout,
                          report::data_value(dataset.sequences.size()),
                          report::data_value(available_sequences(dataset)),
                          static_cast<std::int64_t>(size.bytes), size.is_complete});
  }
  std::cout << report::data_json(table);
  return kExitOk;
}

/// The sequences as a table for programs. Several may be in one archive.
int print_dataset(const CatalogueDataset& dataset) {
  report::DataTable table{.kind = "data_catalogue_sequences",
                          .columns = {"sequence", "group", "archive", "bytes", "digest", "available"},
                          .rows = {},
                          .notes = dataset.notes};
  for (const CatalogueSequence& sequence : dataset.sequences) {
    for (const std::string& file : sequence.archives) {
      const CatalogueArchive& archive = datasets::archive_of(dataset, file);
      table.rows.push_back(
          {catalogue_name(dataset, sequence), report::data_value(sequence.group), file,
           archive.bytes == 0 ? report::DataValue() : report::data_value(std::size_t{archive.bytes}),
           digest_kind(dataset, archive), is_available(dataset, sequence)});
    }
  }
  std::cout << report::data_json(table);
  return kExitOk;
}

int catalogue(const std::string& name, bool json) {
  const std::vector<CatalogueDataset> catalogues = load_catalogues();
  if (name.empty()) return json ? print_datasets(catalogues) : list_datasets(catalogues);
  const auto found = std::ranges::find(catalogues, name, &CatalogueDataset::name);
  if (found != catalogues.end()) return json ? print_dataset(*found) : show_dataset(*found);
  std::vector<std::string> names;
  names.reserve(catalogues.size());
  for (const CatalogueDataset& dataset : catalogues) names.push_back(dataset.name);
  throw InputError("dataset \"" + name + "\"", "is not in the catalogue" + suggestion(name, names) +
                                                   "; `stillpoint data catalogue` lists the datasets");
}

}  // namespace

Command catalogue_command() {
  const auto json = std::make_shared<bool>(false);
  const auto name = std::make_shared<std::string>();
  return {.name = "catalogue",
          .summary = "List public datasets, or the sequences, licence and citation of one",
          .example = "data catalogue tum",
          .options = {{.name = "NAME", .help = "Dataset [all]", .target = name.get(), .may_be_omitted = true},
                      {"--json", report::kJsonHelp, json.get()}},
          .action = [name, json] { return catalogue(*name, *json); }};
}

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

std::vector<CatalogueEntry> selected_entries(const GetArguments& arguments,
                                             const std::vector<CatalogueDataset>& catalogues) {
  if (!arguments.plan.empty()) return plan_entries(arguments.plan, catalogues);
  if (arguments.sequences.empty())
    throw InputError("data get", "requires the name of a sequence, or --for PLAN");
  std::vector<CatalogueEntry> entries;
  for (const std::string& pattern : arguments.sequences) {
    const std::vector<CatalogueEntry> found = datasets::matching_entries(catalogues, pattern);
    if (found.empty()) {
      std::vector<std::string> names;
      for (const CatalogueDataset& dataset : catalogues) {
        for (const CatalogueSequence& sequence : dataset.sequences)
          names.push_back(datasets::catalogue_name(dataset, sequence));
      }
      throw InputError("sequence \"" + pattern + "\"",
                       "is not in the catalogue" + suggestion(pattern, names) +
                           "; `stillpoint data catalogue` lists the datasets");
    }
    for (const CatalogueEntry& entry : found) {
      const bool is_new = std::ranges::none_of(
          entries, [&](const CatalogueEntry& known) { return known.sequence == entry.sequence; });
      if (is_new) entries.push_back(entry);
    }
  }
  return entries;
}

int get(const GetArguments& arguments) {
  install_interrupt_handlers();
  const std::vector<CatalogueDataset> catalogues = load_catalogues();
  const std::vector<CatalogueEntry> entries = selected_entries(arguments, catalogues);
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
  std::cout << fmt::format("{} available\n", counted(entries.size(), "sequence"));
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

namespace {

struct VerifyArguments {
  std::vector<std::string> names;
  std::string root;
};

const char* state_name(VerifiedState state) {
  switch (state) {
    case VerifiedState::kEqual:
      return "unchanged";
    case VerifiedState::kChanged:
      return "CHANGED";
    case VerifiedState::kMissing:
      return "MISSING";
  }
  return "";
}

/// The registered sequences whose names match one of the patterns; all without patterns.
std::vector<RegisteredSequence> selected_registrations(const std::vector<std::string>& patterns) {
  std::vector<RegisteredSequence> selected = read_registry(registry_file());
  if (patterns.empty()) return selected;
  for (const std::string& pattern : patterns) {
    const bool is_known = std::ranges::any_of(selected, [&](const RegisteredSequence& sequence) {
      return fnmatch(pattern.c_str(), sequence.name.c_str(), 0) == 0;
    });
    if (!is_known)
      throw InputError("sequence \"" + pattern + "\"",
                       "is not registered; `stillpoint data list` shows the names");
  }
  std::erase_if(selected, [&](const RegisteredSequence& sequence) {
    return std::ranges::none_of(patterns, [&](const std::string& pattern) {
      return fnmatch(pattern.c_str(), sequence.name.c_str(), 0) == 0;
    });
  });
  return selected;
}

int verify(const VerifyArguments& arguments) {
  install_interrupt_handlers();
  FetchProgress progress;
  int findings = 0;
  int verified = 0;
  const auto print = [&](const std::string& name, VerifiedState state) {
    ++verified;
    if (state != VerifiedState::kEqual) ++findings;
    std::cout << fmt::format("{:<10} {}\n", state_name(state), name) << std::flush;
  };
  for (const RegisteredSequence& sequence : selected_registrations(arguments.names)) {
    if (interrupt_requested()) return kExitInterrupted;
    print(sequence.name + "  " + sequence.folder.string(), verify_sequence(sequence));
  }
  if (arguments.names.empty()) {
    const std::filesystem::path root =
        arguments.root.empty() ? download_root() : std::filesystem::path(arguments.root);
    for (const VerifiedFile& file : verify_archives(root, progress.control().step("verifying archives")))
      print(file.file, file.state);
  }
  if (interrupt_requested()) return kExitInterrupted;
  std::cout << fmt::format("{} verified, {} changed or missing\n", verified, findings);
  return findings == 0 ? kExitOk : kExitFindings;
}

}  // namespace

Command verify_command() {
  const auto arguments = std::make_shared<VerifyArguments>();
  return {.name = "verify",
          .summary =
              "Compare registered sequences and kept archives with the digests of their first use; exit "
              "code 1 if a file changed or is missing",
          .example = "data verify \"tum_*\"",
          .options = {{.name = "NAME",
                       .help = "Registered names or globs [all, and the archives]",
                       .target = &arguments->names,
                       .may_be_omitted = true},
                      {"--to", "Folder of downloads [$STILLPOINT_DATA, else ~/.local/share/stillpoint]",
                       &arguments->root}},
          .action = [arguments] { return verify(*arguments); }};
}

}  // namespace stillpoint::bench
