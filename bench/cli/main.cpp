// SPDX-License-Identifier: BSD-3-Clause
/// The program `stillpoint`.
#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <iostream>

#include "bench/cli/command_line.h"

namespace stillpoint::bench {
namespace {

/// Reserves the descriptors of closed standard streams, so that no output file receives one of them and the
/// text printed to it. A write beyond the file size limit (ulimit -f) becomes an error instead of a signal.
void prepare_process() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    // open() returns the lowest free descriptor. Read-only: writing to it remains an error.
    if (fcntl(stream, F_GETFD) == -1) static_cast<void>(open("/dev/null", O_RDONLY));
  }
  std::signal(SIGXFSZ, SIG_IGN);
}

/// Freed images are used again instead of returned to the system, which would clear their pages for each
/// frame. In a virtual machine that was two thirds of the time of a run with the detector of OpenCV: `run
/// market --config baselines/vins_mono` 26.9 s of user and system time, 10.0 s with these thresholds, on a
/// busy machine.
void keep_freed_buffers() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most that glibc accepts
  mallopt(M_TRIM_THRESHOLD, 64 << 20);
}

/// Flushes stdout. @return `exit_code`, or `kExitBadInput` with a message on stderr if some output was lost
int finish_output(int exit_code) {
  errno = 0;
  std::cout.flush();
  if (std::cout) return exit_code;
  std::cerr << "stillpoint: error: standard output: cannot be written"
            << (errno == 0 ? "" : std::string(": ") + std::strerror(errno))
            << "; free space and run it again\n";
  return kExitBadInput;
}

}  // namespace
}  // namespace stillpoint::bench

int main(int argc, char** argv) {
  using namespace stillpoint::bench;
  prepare_process();
  keep_freed_buffers();
  int exit_code = kExitOk;
  try {
    const auto action = parse_command_line(argc, argv, all_commands());
    exit_code = action();
  } catch (...) {
    exit_code = report_exception();
  }
  return finish_output(exit_code);
}

// Highway measures the resolution of the processor's timer for its micro-benchmarks whenever its shared
// library is loaded, with an instruction (rdtscp) that valgrind rejects on processors, mostly virtual ones,
// that do not report it: no run could count instructions there. This definition in the program takes
// precedence over that of the library; nothing here uses the value.
namespace hwy::platform {

[[gnu::visibility("default")]] std::uint64_t
TimerResolution();  // NOLINT(readability-identifier-naming): the name in Highway
std::uint64_t TimerResolution() { return 1; }

}  // namespace hwy::platform
