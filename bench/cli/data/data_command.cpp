// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/plan/plan_sequences.h"
#include "bench/plan/sequence_registry.h"
#include "bench/record/sequence_checksum.h"
#include "datasets/open_sequence.h"

namespace stillpoint::bench {
namespace {

struct AddArguments {
  std::string name;
  std::string folder;
  bool force = false;
};

int add(const AddArguments& arguments) {
  const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(arguments.folder);
  const RegisteredSequence sequence{.name = arguments.name,
                                    .folder = std::filesystem::canonical(arguments.folder),
                                    .checksum = sequence_checksum(arguments.folder),
                                    .format = stream->info().format};
  for (const std::string& warning : stream->info().warnings) spdlog::warn("{}", warning);
  if (stream->info().detections.empty())
    spdlog::info(
        "no recorded boxes (detections.txt); `stillpoint detect` records them, but changes the checksum");
  register_sequence(registry_file(), sequence, arguments.force ? Registration::kReplace : Registration::kNew);
  std::cout << fmt::format("registered {}: {} ({}, {} frames, checksum {})\n", sequence.name,
                           sequence.folder.string(), sequence.format, stream->info().frame_times.size(),
                           sequence.checksum);
  return kExitOk;
}

/// Whether each registered sequence can be used, and the folders of the data folder, which need no
/// registration.
int list() {
  const std::vector<RegisteredSequence> registry = read_registry(registry_file());
  for (const RegisteredSequence& sequence : registry) {
    std::cout << fmt::format("{:<32} {:<10} {}  {}{}\n", sequence.name, sequence.format, sequence.checksum,
                             sequence.folder.string(),
                             datasets::is_sequence_path(sequence.folder) ? "" : "  (missing)");
  }
  std::cout << fmt::format(
      "{} registered sequences; plans can also use the folders in {} by their names, and any folder by its "
      "path\n",
      registry.size(), data_folder().string());
  return kExitOk;
}

Command add_command() {
  const auto arguments = std::make_shared<AddArguments>();
  return {
      .name = "add",
      .summary = "Register a recorded sequence under a name for plans; stores its current checksum",
      .example = "data add cafe1 /data/openloris/cafe1-1",
      .options = {{"NAME", "Name of the sequence in plans", &arguments->name},
                  {"DIR", "Sequence folder or bag", &arguments->folder},
                  {"--force", "Replace the registration of the name for another folder", &arguments->force}},
      .action = [arguments] { return add(*arguments); }};
}

Command list_command() {
  return {.name = "list",
          .summary = "List the sequences that plans can use",
          .example = "data list",
          .action = list};
}

}  // namespace

Command data_command() {
  return {
      .name = "data",
      .summary = "Download, create and inspect sequences",
      .example = "data synth walking_xyz --out build/walking_xyz",
      .subcommands = {catalogue_command(), get_command(), verify_command(), list_command(), add_command(),
                      check_command(), synth_command(), export_command(), cache_command(), faults_command()}};
}

}  // namespace stillpoint::bench
