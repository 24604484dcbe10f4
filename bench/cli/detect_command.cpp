// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/cli/progress.h"
#include "bench/config/config_file.h"
#include "bench/record/output_folder.h"
#include "bench/run/sequence_source.h"
#include "core/base/error.h"
#include "core/detector/object_detector.h"
#include "datasets/detections_file.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// What the command line of `detect` says.
struct DetectArguments {
  std::string sequence;
  std::string out;
  std::string weights, cfg, names;
  std::string base = "stillpoint";
  std::vector<std::string> settings;
  std::string format;
  int max_frames = 0;
};

/// The config with the network that the options name.
OdometryConfig config_of(const DetectArguments& arguments) {
  OdometryConfig config = load_config({arguments.base, "", arguments.settings});
  const auto take = [](std::string& value, const std::string& given) {
    if (!given.empty()) value = given;
  };
  take(config.detector.weights, arguments.weights);
  take(config.detector.cfg, arguments.cfg);
  take(config.detector.names, arguments.names);
  config.detector.kind = DetectorKind::kNetwork;
  return config;
}

/// The picture's boxes; nobody looked at a picture that cannot be read.
DetectionSet detect_in(const SensorStream& stream, std::size_t index, ObjectDetector& detector) {
  Frame frame;
  try {
    frame = stream.load_frame(index);
  } catch (const InputError& error) {
    std::cerr << "stillpoint: warning: frame " << index << " skipped: " << error.what() << "\n";
    return {.t = stream.info().frame_times[index], .state = DetectionState::kNone, .detections = {}};
  }
  return detector.detect(frame);
}

void print_summary(const ObjectDetector& detector, const fs::path& file) {
  const DetectorCounters& counters = detector.counters();
  std::cout << fmt::format("{} boxes in {} pictures, {} cut at the edge, {} unusable ({})\n  {}\n",
                           counters.boxes, counters.looked, counters.clipped, counters.unusable,
                           detector.description(), file.string());
}

int detect(const DetectArguments& arguments) {
  if (arguments.out.empty()) throw InputError("--out", "names the file for the boxes; give one");
  if (arguments.max_frames < 0) throw InputError("--max-frames", "must not be negative; 0 means all");
  const fs::path file = fs::absolute(arguments.out);
  const OdometryConfig config = config_of(arguments);
  watch_interrupts();
  const std::unique_ptr<ObjectDetector> detector =
      make_object_detector(config.detector, {.dynamic_classes = config.dynamic.classes});
  const std::unique_ptr<SensorStream> stream = find_sequence(arguments.sequence, {.format = arguments.format},
                                                             {.stop_requested = interrupt_requested});
  if (!stream) return kExitInterrupted;
  require_writable(file.parent_path());

  const std::size_t all = stream->info().frame_times.size();
  const auto most = static_cast<std::size_t>(arguments.max_frames);
  const std::size_t frames = most == 0 ? all : std::min(all, most);
  std::vector<DetectionSet> sets;
  {
    ProgressLine progress("detecting in " + stream->info().name, frames, "frames");
    for (std::size_t i = 0; i < frames; ++i) {
      if (interrupt_requested()) return kExitInterrupted;
      sets.push_back(detect_in(*stream, i, *detector));
      progress.update(i + 1);
    }
  }
  write_files(file.parent_path(), {{file.filename().string(), detections_text(sets)}});
  print_summary(*detector, file);
  return kExitOk;
}

}  // namespace

Command detect_command() {
  const auto arguments = std::make_shared<DetectArguments>();
  return {
      .name = "detect",
      .summary = "Run a detection network over a sequence once and record its boxes",
      .example =
          "detect my_sequence --weights yolo.weights --cfg yolo.cfg --names coco.names --out "
          "my_sequence/detections.txt",
      .options = {{"SEQ", "Sequence folder, or the name of a rendered one", &arguments->sequence},
                  {"--out", "File for the boxes; detections.txt in the sequence's folder is found by run",
                   &arguments->out},
                  {"--weights", "Network: Darknet .weights or .onnx [detector.weights]", &arguments->weights},
                  {"--cfg", "Darknet's description of the network [detector.cfg]", &arguments->cfg},
                  {"--names", "Its classes, a line each [detector.names]", &arguments->names},
                  {"--config", "Base config: an embedded name or a TOML file", &arguments->base},
                  {"--set", "Change one key: key=value, may be repeated", &arguments->settings},
                  {"--format", "Layout of the folder [recognised]", &arguments->format},
                  {"--max-frames", "Stop after this many pictures; 0 = all", &arguments->max_frames}},
      .action = [arguments] { return detect(*arguments); },
      .subcommands = {}};
}

}  // namespace stillpoint
