// SPDX-License-Identifier: BSD-3-Clause
/// Ctrl-C as a polite request: the first one is noted, the second one kills.
#pragma once

namespace stillpoint {

/// From now on SIGINT and SIGTERM are noted, once each.
void watch_interrupts();

/// True after a signal that `watch_interrupts` waits for.
[[nodiscard]] bool interrupt_requested();

}  // namespace stillpoint
