// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/data/fetch_progress.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "bench/cli/interrupt.h"
#include "bench/cli/progress.h"
#include "bench/fetch/data_lock.h"
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

void accept_licences(const std::vector<datasets::CatalogueEntry>& entries, const std::filesystem::path& root,
                     bool accepted_by_option) {
  std::filesystem::create_directories(root);
  for (const datasets::CatalogueDataset* dataset : unaccepted_licences(entries, root)) {
    std::cout << fmt::format("{}\n  licence: {}\n  {}\n", dataset->title, dataset->licence, dataset->homepage)
              << std::flush;
    if (!accepted_by_option) {
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

}  // namespace stillpoint::bench
