// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/serve/static_server.h"
#include "bench/store/store.h"
#include "reports/dashboard/dashboard.h"

namespace stillpoint::bench {
namespace {

struct ServeArguments {
  std::string store;
  ServerOptions server;
};

int serve(const ServeArguments& arguments) {
  block_interrupts();
  const StaticServer server(report::dashboard_files(Store(arguments.store)), arguments.server);
  spdlog::info("serving http://{}:{}/ (current content of the store); press Ctrl-C to stop",
               arguments.server.address, server.port());
  if (!arguments.server.address.starts_with("127."))
    spdlog::warn("{} is not a loopback address: the dashboard is accessible from other machines",
                 arguments.server.address);
  wait_for_interrupt();
  return kExitOk;
}

}  // namespace

Command serve_command() {
  const auto arguments = std::make_shared<ServeArguments>();
  return {.name = "serve",
          .summary = "Serve the dashboard of a store over HTTP",
          .example = "serve build/bench/store.sqlite --port 8035",
          .options =
              {{"STORE", "Store with the runs of several commits", &arguments->store},
               {"--port", "Port to listen on; 0 = any free port [8035]", &arguments->server.port, {0, 65535}},
               {"--address",
                "IPv4 address to listen on; addresses other than loopback give other machines access "
                "[127.0.0.1]",
                &arguments->server.address}},
          .action = [arguments] { return serve(*arguments); }};
}

}  // namespace stillpoint::bench
