// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/config/config_file.h"
#include "bench/fetch/box_recording.h"
#include "bench/fetch/fetch_sequences.h"
#include "bench/plan/plan_sequences.h"
#include "bench/record/output_folder.h"
#include "bench/run/sequence_source.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "core/detector/object_detector.h"
#include "datasets/io/detections_file.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// Command line arguments of `detect`.
struct DetectArguments {
  std::string sequence;
  std::string out;
  std::string weights, cfg, names;
  std::string base = "stillpoint";
  std::vector<std::string> settings;
  std::string format;
  int max_frames = 0;
  bool force = false;
};

/// The downloaded network, if neither the options nor the config name one.
/// @throws InputError if there is none
OdometryConfig with_downloaded_network(OdometryConfig config) {
  const std::optional<DetectorConfig> network = downloaded_network(download_root());
  if (!network)
    throw InputError(
        "detector.weights and detector.names",
        "are not set; pass --weights, --cfg and --names, or download a network: `stillpoint data "
        "get yolo_fastest/coco`");
  config.detector.weights = network->weights;
  config.detector.cfg = network->cfg;
  config.detector.names = network->names;
  return config;
}

/// The config with the detection network of the options.
OdometryConfig config_of(const DetectArguments& arguments) {
  OdometryConfig config = load_config({arguments.base, "", arguments.settings});
  const auto override_with = [](std::string& value, const std::string& given) {
    if (!given.empty()) value = given;
  };
  override_with(config.detector.weights, arguments.weights);
  override_with(config.detector.cfg, arguments.cfg);
  override_with(config.detector.names, arguments.names);
  if (config.detector.weights.empty() && config.detector.cfg.empty() && config.detector.names.empty())
    config = with_downloaded_network(std::move(config));
  config.detector.kind = DetectorKind::kNetwork;
  return config;
}

void print_summary(const ObjectDetector& detector, const fs::path& file) {
  const DetectorCounters& counters = detector.counters();
  std::cout << fmt::format("{} in {}, {} clipped to the image, {} rejected ({})\n  {}\n",
                           counters.boxes == 1 ? "1 box" : fmt::format("{} boxes", counters.boxes),
                           counted(static_cast<std::size_t>(counters.processed), "frame"), counters.clipped,
                           counters.rejected, detector.description(), file.string());
}

int detect(const DetectArguments& arguments) {
  if (arguments.out.empty()) throw InputError("--out", "is required: the output file of the boxes");
  const fs::path file = fs::absolute(arguments.out);
  const OdometryConfig config = config_of(arguments);
  const OutputRules rules{.inputs = {config.detector.weights, config.detector.cfg, config.detector.names},
                          .force = arguments.force,
                          .beginning = datasets::detections_header()};
  require_safe_output(file, rules);
  const std::string sequence = resolve_sequence(arguments.sequence);
  install_interrupt_handlers();
  const std::unique_ptr<ObjectDetector> detector =
      make_object_detector(config.detector, {.dynamic_classes = config.dynamic.classes});
  const std::unique_ptr<datasets::SensorStream> stream =
      find_sequence(sequence, {.format = arguments.format}, {.stop_requested = interrupt_requested});
  if (!stream) return kExitInterrupted;
  require_writable(file.parent_path());

  const std::size_t available = stream->info().frame_times.size();
  const auto max_frames = static_cast<std::size_t>(arguments.max_frames);
  const std::size_t frames = max_frames == 0 ? available : std::min(available, max_frames);
  std::vector<DetectionSet> sets;
  {
    ProgressLine line("detecting in " + stream->info().name, frames, "frames");
    sets = detect_boxes(*stream, *detector, frames,
                        {.stop = interrupt_requested,
                         .progress = [&line](std::size_t done) { line.update(done); },
                         .skipped =
                             [](std::size_t frame, const std::string& problem) {
                               std::cerr << "stillpoint: warning: frame " << frame << " skipped: " << problem
                                         << "\n";
                             }});
  }
  if (sets.size() < frames) return kExitInterrupted;
  write_output(file, datasets::detections_text(sets), rules);
  print_summary(*detector, file);
  return kExitOk;
}

}  // namespace

Command detect_command() {
  const auto arguments = std::make_shared<DetectArguments>();
  return {
      .name = "detect",
      .summary = "Run a detection network on a sequence and record its boxes",
      .example =
          "detect my_sequence --weights yolo.weights --cfg yolo.cfg --names coco.names --out "
          "my_sequence/detections.txt",
      .options = {{"SEQ", "Sequence folder or preset name", &arguments->sequence},
                  {"--out", "Output file; `run` reads detections.txt of the sequence folder",
                   &arguments->out},
                  {"--force", "Replace an existing file of detections", &arguments->force},
                  {"--weights",
                   "Network file: Darknet .weights or .onnx [detector.weights, else the downloaded network]",
                   &arguments->weights},
                  {"--cfg", "Darknet network description [detector.cfg]", &arguments->cfg},
                  {"--names", "Class names, one per line [detector.names]", &arguments->names},
                  {"--config", "Base config: an embedded name or a TOML file", &arguments->base},
                  {"--set", "Override a config key: key=value; may be repeated", &arguments->settings},
                  {"--format", "Sequence format [detected]", &arguments->format},
                  {"--max-frames", "Maximum number of frames; 0 = all", &arguments->max_frames, {0, 1e9}}},
      .action = [arguments] { return detect(*arguments); }};
}

}  // namespace stillpoint::bench
