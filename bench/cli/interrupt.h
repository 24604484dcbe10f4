// SPDX-License-Identifier: BSD-3-Clause
/// Ctrl-C as a polite request: the first one is noted, the second one kills.
#pragma once

namespace stillpoint {

/// From now on SIGINT and SIGTERM are noted, once each.
void watch_interrupts();

/// True after a signal that `watch_interrupts` waits for.
[[nodiscard]] bool interrupt_requested();

/// From now on SIGINT and SIGTERM wait for `await_interrupt`, in this thread and those that it starts.
void hold_interrupts();

/// Returns at the first of them.
void await_interrupt();

}  // namespace stillpoint
