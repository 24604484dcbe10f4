// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/progress.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace stillpoint {
namespace {
constexpr std::chrono::milliseconds kRedrawInterval{100};
constexpr const char* kWipe = "\r\033[K";
}  // namespace

std::string span_text(double seconds) {
  const auto whole = std::llround(seconds);
  if (whole < 60) return fmt::format("{} s", whole);
  const auto minutes = std::llround(seconds / 60.0);
  if (minutes < 60) return fmt::format("{} min", minutes);
  return fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

ProgressLine::ProgressLine(std::string label, std::size_t total, std::string unit)
    : label_(std::move(label)),
      total_(total),
      unit_(std::move(unit)),
      visible_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()) {}

ProgressLine::~ProgressLine() { wipe(); }

void ProgressLine::wipe() const {
  if (visible_) fmt::print(stderr, "{}", kWipe);
}

void ProgressLine::draw() const {
  if (!visible_) return;
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double rate = elapsed_s > 0.0 ? static_cast<double>(done_) / elapsed_s : 0.0;
  const std::string rest = rate > 0.0 ? span_text(static_cast<double>(total_ - done_) / rate) : "?";
  fmt::print(stderr, "{}{}: {} of {} {}, {:.3g}/s, {} left", kWipe, label_, done_, total_, unit_, rate, rest);
  std::fflush(stderr);
}

void ProgressLine::update(std::size_t done) {
  done_ = done;
  const auto now = std::chrono::steady_clock::now();
  if (now - drawn_ < kRedrawInterval) return;
  drawn_ = now;
  draw();
}

}  // namespace stillpoint
