// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/serve/static_server.h"
#include "bench/store/store.h"
#include "reports/dashboard/dashboard.h"

namespace stillpoint {
namespace {

struct ServeArguments {
  std::string store;
  ServerOptions server;
};

int serve(const ServeArguments& arguments) {
  hold_interrupts();
  const StaticServer server(dashboard_files(Store(arguments.store)), arguments.server);
  spdlog::info("serving http://{}:{}/ as the store is now; Ctrl-C ends it", arguments.server.address,
               server.port());
  if (!arguments.server.address.starts_with("127."))
    spdlog::warn("{} is no loopback address: other machines can read the numbers", arguments.server.address);
  await_interrupt();
  return kExitOk;
}

}  // namespace

Command serve_command() {
  const auto arguments = std::make_shared<ServeArguments>();
  return {.name = "serve",
          .summary = "Show the dashboard of a store to browsers on this machine",
          .example = "serve build/bench/store.sqlite --port 8035",
          .options = {{"STORE", "Store that `stillpoint bench` filled at many commits", &arguments->store},
                      {"--port", "Port to listen on; 0: any that is free [8035]", &arguments->server.port},
                      {"--address",
                       "IPv4 address to listen on; others than loopback let other machines read the "
                       "numbers [127.0.0.1]",
                       &arguments->server.address}},
          .action = [arguments] { return serve(*arguments); },
          .subcommands = {}};
}

}  // namespace stillpoint
