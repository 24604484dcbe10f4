// SPDX-License-Identifier: BSD-3-Clause
/// Handling of SIGINT and SIGTERM: the first signal requests a stop, the second one terminates the process.
#pragma once

namespace stillpoint::bench {

/// Installs one-shot handlers for SIGINT and SIGTERM that set a flag.
void install_interrupt_handlers();

/// True once a handler of `install_interrupt_handlers` was called.
[[nodiscard]] bool interrupt_requested();

/// Blocks SIGINT and SIGTERM in this thread and in threads created by it later.
void block_interrupts();

/// Waits for SIGINT or SIGTERM, which must be blocked (`block_interrupts`).
void wait_for_interrupt();

}  // namespace stillpoint::bench
