// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/console.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

#include <fmt/format.h>

#include "core/base/counted.h"

namespace stillpoint::bench {
namespace {

constexpr std::chrono::milliseconds kRedrawInterval{100};
constexpr std::chrono::seconds kLineInterval{10};  // without a terminal
constexpr const char* kClearLine = "\r\033[K";

// A global, as a signal handler has no other state. The only one of the program.
volatile std::sig_atomic_t g_interrupted = 0;

void on_signal(int) { g_interrupted = 1; }

sigset_t interrupt_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

}  // namespace

void install_interrupt_handlers() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupt_requested() { return g_interrupted != 0; }

void require_uninterrupted() {
  if (interrupt_requested()) throw Interrupted{};
}

void block_interrupts() {
  const sigset_t signals = interrupt_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

void wait_for_interrupt() {
  const sigset_t signals = interrupt_signals();
  int signal = 0;
  sigwait(&signals, &signal);
}

bool interrupted_within(std::chrono::milliseconds time) {
  const sigset_t signals = interrupt_signals();
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
  const timespec limit{.tv_sec = seconds.count(),
                       .tv_nsec = std::chrono::nanoseconds(time - seconds).count()};
  return sigtimedwait(&signals, nullptr, &limit) > 0;
}

ProgressLine::ProgressLine(std::string label, std::size_t total, std::string unit)
    : label_(std::move(label)),
      total_(total),
      unit_(std::move(unit)),
      visible_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      drawn_(start_) {}

ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::clear() const {
  if (visible_) fmt::print(stderr, "{}", kClearLine);
}

std::string ProgressLine::text() const {
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double rate = elapsed_s > 0.0 ? static_cast<double>(done_) / elapsed_s : 0.0;
  const std::string remaining = rate > 0.0 ? duration_text(static_cast<double>(total_ - done_) / rate) : "?";
  return fmt::format("{}: {} of {} {}, {:.3g}/s, {} left", label_, done_, total_, unit_, rate, remaining);
}

void ProgressLine::draw() const {
  if (!visible_) return;
  fmt::print(stderr, "{}{}", kClearLine, text());
  std::fflush(stderr);
}

void ProgressLine::update(std::size_t done, std::string label) {
  label_ = std::move(label);
  update(done);
}

void ProgressLine::update(std::size_t done) {
  done_ = done;
  const auto now = std::chrono::steady_clock::now();
  if (now - drawn_ < (visible_ ? std::chrono::nanoseconds(kRedrawInterval) : kLineInterval)) return;
  drawn_ = now;
  if (!visible_) fmt::print(stderr, "{}\n", text());
  draw();
}

std::string duration_text(double seconds) {
  const auto whole_seconds = std::llround(seconds);
  if (whole_seconds < 60) return fmt::format("{} s", whole_seconds);
  const auto minutes = std::llround(seconds / 60.0);
  if (minutes < 60) return fmt::format("{} min", minutes);
  return fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

std::string rate_text(std::size_t runs, double seconds) {
  return fmt::format("{} in {}, {:.3g} runs per minute", counted(runs, "run"), duration_text(seconds),
                     60.0 * static_cast<double>(runs) / std::max(seconds, 1e-3));
}

}  // namespace stillpoint::bench
