// SPDX-License-Identifier: BSD-3-Clause
/// Serves the files of a folder on 127.0.0.1, with ranges, until it is interrupted.
///   mirror_server FOLDER PORT
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/fault_server.h"

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  if (argc != 3 || !fs::is_directory(argv[1])) {
    std::fputs("usage: mirror_server FOLDER PORT\n", stderr);
    return 2;
  }
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  const fs::path folder = argv[1];
  const stillpoint::FaultServer server(
      [&folder](const stillpoint::ServedRequest& request) -> stillpoint::ServedResponse {
        const fs::path file = (folder / request.path.substr(1)).lexically_normal();
        const bool is_inside = file.string().starts_with(folder.lexically_normal().string());
        if (!is_inside || !fs::is_regular_file(file)) return {.status = 404, .headers = {}, .body = ""};
        std::ifstream input(file, std::ios::binary);
        const std::string content{std::istreambuf_iterator<char>(input), {}};
        return stillpoint::file_response(request, content, "\"" + std::to_string(content.size()) + "\"");
      },
      std::stoi(argv[2]));
  std::printf("http://127.0.0.1:%d\n", server.port());
  std::fflush(stdout);
  int signal = 0;
  sigwait(&signals, &signal);
  return 0;
}
