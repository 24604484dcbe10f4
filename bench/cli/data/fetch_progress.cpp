// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/data/fetch_progress.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "bench/cli/console.h"
#include "bench/fetch/data_lock.h"
#include "bench/plan/bench_plan.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "datasets/cache/cache_space.h"

namespace stillpoint::bench {

/// One line on the terminal; the rate is that of this call, without what an earlier one has transferred.
class ByteProgress {
 public:
  explicit ByteProgress(std::string label) : label_(std::move(label)), start_(Clock::now()) {}
  ~ByteProgress() { clear(); }
  ByteProgress(const ByteProgress&) = delete;
  ByteProgress& operator=(const ByteProgress&) = delete;

  void clear() const {
    if (visible_) fmt::print(stderr, "\r\033[K");
  }

  void update(std::uint64_t done, std::uint64_t total) {
    if (first_ > done) first_ = done;
    const Clock::time_point now = Clock::now();
    if (!visible_ || now - drawn_ < std::chrono::milliseconds(100)) return;
    drawn_ = now;
    const double elapsed_s = std::chrono::duration<double>(now - start_).count();
    const double rate = static_cast<double>(done - first_) / std::max(elapsed_s, 1e-3);
    const std::string of_total = total == 0 ? "" : " of " + datasets::size_text(total);
    const std::string left = total <= done || rate <= 0.0
                                 ? ""
                                 : ", " + duration_text(static_cast<double>(total - done) / rate) + " left";
    fmt::print(stderr, "\r\033[K{}: {}{}, {}/s{}", label_, datasets::size_text(done), of_total,
               datasets::size_text(static_cast<std::uint64_t>(rate)), left);
    std::fflush(stderr);
  }

 private:
  using Clock = std::chrono::steady_clock;

  std::string label_;
  bool visible_ = isatty(STDERR_FILENO) == 1;
  std::uint64_t first_ = UINT64_MAX;  ///< bytes at the first call
  Clock::time_point start_;
  Clock::time_point drawn_;
};

FetchProgress::FetchProgress() = default;
FetchProgress::~FetchProgress() = default;

FetchControl FetchProgress::control() {
  const auto report = [this](const std::string& text) {
    line_.reset();
    std::cout << text << "\n" << std::flush;
  };
  const auto step = [this](const std::string& label) {
    line_ = std::make_unique<ByteProgress>(label);
    if (isatty(STDERR_FILENO) != 1) spdlog::info("{}", label);
    return datasets::TransferControl{.progress =
                                         [this](std::uint64_t done, std::uint64_t total) {
                                           if (line_) line_->update(done, total);
                                         },
                                     .stop = interrupt_requested,
                                     .report =
                                         [this](const std::string& text) {
                                           if (line_) line_->clear();
                                           spdlog::warn("{}", text);
                                         }};
  };
  return {.step = step, .report = report};
}

namespace {

/// Prints each licence that has not been accepted, and records its acceptance.
void accept_licences(const std::vector<datasets::CatalogueEntry>& entries, const std::filesystem::path& root,
                     LicenceAnswer answer_by_option) {
  std::filesystem::create_directories(root);
  for (const datasets::CatalogueDataset* dataset : unaccepted_licences(entries, root)) {
    std::cout << fmt::format("{}\n  licence: {}\n  {}\n", dataset->title, dataset->licence, dataset->homepage)
              << std::flush;
    if (answer_by_option == LicenceAnswer::kAsk) {
      const std::string problem =
          "the licence \"" + dataset->licence + "\" has not been accepted; specify --accept-licence";
      if (isatty(STDIN_FILENO) != 1) throw InputError(dataset->name, problem);
      std::cout << "Accept this licence? [y/N] " << std::flush;
      std::string answer;
      std::getline(std::cin, answer);
      if (answer != "y" && answer != "Y") throw InputError(dataset->name, problem);
    }
    lock_licence(root, dataset->name);
  }
}

/// One line about what will be downloaded.
void print_selection(const std::vector<datasets::CatalogueEntry>& entries,
                     const std::filesystem::path& root) {
  std::size_t available = 0;
  std::set<std::string> archives;
  std::uint64_t bytes = 0;
  bool has_unknown = false;
  for (const datasets::CatalogueEntry& entry : entries) {
    if (is_available(*entry.dataset, *entry.sequence)) {
      ++available;
      continue;
    }
    for (const std::string& file : entry.sequence->archives) {
      if (!archives.insert(entry.dataset->name + "/" + file).second) continue;
      const std::uint64_t size = datasets::archive_of(*entry.dataset, file).bytes;
      bytes += size;
      has_unknown = has_unknown || size == 0;
    }
  }
  std::cout << fmt::format("{}, {} available; {} to download to {}", counted(entries.size(), "sequence"),
                           available, counted(archives.size(), "archive"), root.string());
  if (bytes > 0) std::cout << (has_unknown ? ", more than " : ", ") << datasets::size_text(bytes);
  std::cout << "\n" << std::flush;
}

}  // namespace

std::vector<datasets::CatalogueEntry> plan_entries(
    const std::string& plan, const std::vector<datasets::CatalogueDataset>& catalogues) {
  std::vector<datasets::CatalogueEntry> entries;
  for (const std::string& pattern : load_plan(plan).recorded.sequences) {
    for (const datasets::CatalogueEntry& entry : datasets::matching_entries(catalogues, pattern))
      entries.push_back(entry);
  }
  if (entries.empty()) throw InputError("plan \"" + plan + "\"", "has no sequences of the catalogue");
  return entries;
}

FetchResult fetch_with_progress(const std::vector<datasets::CatalogueEntry>& entries, FetchOptions options,
                                LicenceAnswer licence) {
  if (options.root.empty()) options.root = download_root();
  const char* mirror = std::getenv("STILLPOINT_MIRROR");
  if (options.mirror.empty() && mirror != nullptr) options.mirror = mirror;
  accept_licences(entries, options.root, licence);
  print_selection(entries, options.root);
  FetchProgress progress;
  FetchResult result = fetch_sequences(entries, options, progress.control());
  if (result.stopped) std::cout << "interrupted; run the command again to continue\n";
  return result;
}

}  // namespace stillpoint::bench
