// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/progress.h"

#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace stillpoint {
namespace {
constexpr std::chrono::milliseconds kRedrawInterval{100};
constexpr const char* kWipe = "\r\033[K";
}  // namespace

ProgressLine::ProgressLine(std::string label, std::size_t total, std::string unit)
    : label_(std::move(label)),
      total_(total),
      unit_(std::move(unit)),
      visible_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()) {}

ProgressLine::~ProgressLine() {
  if (visible_) fmt::print(stderr, "{}", kWipe);
}

void ProgressLine::update(std::size_t done) {
  const auto now = std::chrono::steady_clock::now();
  if (!visible_ || now - drawn_ < kRedrawInterval) return;
  drawn_ = now;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const double rate = elapsed_s > 0.0 ? static_cast<double>(done) / elapsed_s : 0.0;
  fmt::print(stderr, "{}{}: {} of {} {}, {:.0f}/s", kWipe, label_, done, total_, unit_, rate);
  std::fflush(stderr);
}

}  // namespace stillpoint
