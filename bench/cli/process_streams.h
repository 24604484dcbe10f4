// SPDX-License-Identifier: BSD-3-Clause
/// Standard streams and signals of the process, set up so that failed writes are reported.
#pragma once

namespace stillpoint::bench {

/// Reserves the descriptors of closed standard streams, so that no output file receives one of them and the
/// text printed to it. A write beyond the file size limit (ulimit -f) becomes an error instead of a signal.
/// Call it first.
void prepare_process();

/// Flushes stdout. @return `exit_code`, or `kExitBadInput` with a message on stderr if some output was lost
[[nodiscard]] int finish_output(int exit_code);

}  // namespace stillpoint::bench
