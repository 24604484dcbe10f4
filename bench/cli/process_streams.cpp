// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/process_streams.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <iostream>

#include <fcntl.h>
#include <unistd.h>

#include "bench/cli/command_line.h"

namespace stillpoint::bench {

void prepare_process() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    // open() returns the lowest free descriptor. Read-only: writing to it remains an error.
    if (fcntl(stream, F_GETFD) == -1) static_cast<void>(open("/dev/null", O_RDONLY));
  }
  std::signal(SIGXFSZ, SIG_IGN);
}

int finish_output(int exit_code) {
  errno = 0;
  std::cout.flush();
  if (std::cout) return exit_code;
  std::cerr << "stillpoint: error: standard output: cannot be written"
            << (errno == 0 ? "" : std::string(": ") + std::strerror(errno))
            << "; free space and run it again\n";
  return kExitBadInput;
}

}  // namespace stillpoint::bench
