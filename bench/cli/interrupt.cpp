// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/interrupt.h"

#include <csignal>

namespace stillpoint::bench {
namespace {

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
  action.sa_flags = SA_RESETHAND;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupt_requested() { return g_interrupted != 0; }

void block_interrupts() {
  const sigset_t signals = interrupt_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

void wait_for_interrupt() {
  const sigset_t signals = interrupt_signals();
  int signal = 0;
  sigwait(&signals, &signal);
}

}  // namespace stillpoint::bench
