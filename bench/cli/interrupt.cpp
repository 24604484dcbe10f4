// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/interrupt.h"

#include <csignal>

namespace stillpoint {
namespace {

// The one global of the program: a signal handler can reach nothing else.
volatile std::sig_atomic_t g_interrupted = 0;

void note_signal(int) { g_interrupted = 1; }

}  // namespace

void watch_interrupts() {
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = SA_RESETHAND;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupt_requested() { return g_interrupted != 0; }

}  // namespace stillpoint
