// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iostream>
#include <memory>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/cli/progress.h"
#include "bench/plan/sequence_argument.h"
#include "bench/run/sequence_source.h"
#include "core/base/error.h"
#include "datasets/sequence_export.h"

namespace stillpoint::bench {
namespace {

struct ExportArguments {
  std::string sequence;
  std::string out;
  std::string layout = "bag";
  std::string compression = "none";
  std::string format;
  std::string rig;
  std::vector<std::string> topics;
};

void write(const datasets::SensorStream& stream, const ExportArguments& arguments,
           const datasets::ExportControl& control) {
  if (arguments.layout == "tum") {
    datasets::export_tum(stream, arguments.out, control);
  } else if (arguments.layout == "euroc") {
    datasets::export_euroc(stream, arguments.out, control);
  } else {
    datasets::export_bag(stream, arguments.out, arguments.compression, control);
  }
}

int export_sequence(const ExportArguments& arguments) {
  if (arguments.layout != "tum" && arguments.layout != "euroc" && arguments.layout != "bag")
    throw InputError("--layout", "\"" + arguments.layout + "\" is unknown; expected one of: tum, euroc, bag");
  if (arguments.out.empty()) throw InputError("--out", "is required: the output folder or bag");
  if (std::filesystem::exists(arguments.out))
    throw InputError("--out", arguments.out + " exists; choose another name or remove it");
  install_interrupt_handlers();
  const std::unique_ptr<datasets::SensorStream> stream =
      find_sequence(resolve_sequence(arguments.sequence),
                    {.format = arguments.format, .rig_file = arguments.rig, .topics = arguments.topics},
                    {.stop_requested = interrupt_requested});
  if (!stream) return kExitInterrupted;
  const std::filesystem::path parent = std::filesystem::absolute(arguments.out).parent_path();
  std::filesystem::create_directories(parent);
  {
    ProgressLine line("exporting " + stream->info().name, stream->info().frame_times.size(), "frames");
    const datasets::ExportControl control{
        .progress = [&line](std::size_t done, std::size_t) { line.update(done); },
        .stop_requested = interrupt_requested};
    write(*stream, arguments, control);
  }
  std::cout << arguments.out << '\n';
  return kExitOk;
}

}  // namespace

Command export_command() {
  const auto arguments = std::make_shared<ExportArguments>();
  return {
      .name = "export",
      .summary = "Write a sequence of any format in another layout, for other systems",
      .example = "data export my_sequence --layout bag --out my_sequence.bag",
      .options =
          {{"SEQ", "Sequence folder, bag or preset name", &arguments->sequence},
           {"--layout",
            "Output layout: tum, euroc, or bag (--out FILE.bag for ROS 1, FILE.mcap, or a folder of rosbag2)",
            &arguments->layout},
           {"--out", "Output folder or bag; must not exist", &arguments->out},
           {"--compression", "Of a bag: none, bz2 (ROS 1), lz4 (ROS 1, MCAP) or zstd (MCAP)",
            &arguments->compression},
           {"--format", "Format of the input [detected]", &arguments->format},
           {"--rig", "rig.toml that overrides the calibration of the input", &arguments->rig},
           {"--topics", kTopicsHelp, &arguments->topics}},
      .action = [arguments] { return export_sequence(*arguments); }};
}

}  // namespace stillpoint::bench
