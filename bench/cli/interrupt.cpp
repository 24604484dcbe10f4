// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/interrupt.h"

#include <csignal>

namespace stillpoint {
namespace {

// The one global of the program: a signal handler can reach nothing else.
volatile std::sig_atomic_t g_interrupted = 0;

void note_signal(int) { g_interrupted = 1; }

sigset_t interrupts() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

}  // namespace

void watch_interrupts() {
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = SA_RESETHAND;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupt_requested() { return g_interrupted != 0; }

void hold_interrupts() {
  const sigset_t signals = interrupts();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

void await_interrupt() {
  const sigset_t signals = interrupts();
  int signal = 0;
  sigwait(&signals, &signal);
}

}  // namespace stillpoint
