// SPDX-License-Identifier: BSD-3-Clause
#include "bench/fetch/box_recording.h"

#include <algorithm>
#include <memory>

#include "bench/config/config_file.h"
#include "bench/fetch/data_lock.h"
#include "bench/plan/sequence_registry.h"
#include "bench/record/output_folder.h"
#include "core/base/error.h"
#include "datasets/io/detections_file.h"
#include "datasets/open_sequence.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using datasets::CatalogueDataset;

constexpr std::size_t kNetworkFiles = 3;  // weights, cfg, names

OdometryConfig network_config(const CatalogueDataset& network, const fs::path& root) {
  const std::vector<std::string>& files = network.sequences.front().archives;
  if (files.size() != kNetworkFiles)
    throw InputError("catalogue of " + network.name, "a detector has three files: weights, cfg and names");
  OdometryConfig config = load_config({"stillpoint", "", {}});
  config.detector.kind = DetectorKind::kNetwork;
  config.detector.weights = download_path(root, network, files[0]).string();
  config.detector.cfg = download_path(root, network, files[1]).string();
  config.detector.names = download_path(root, network, files[2]).string();
  return config;
}

const CatalogueDataset& network_of(const std::vector<CatalogueDataset>& catalogues) {
  const auto network = std::ranges::find(catalogues, kDetectorLayout, &CatalogueDataset::layout);
  STILLPOINT_CHECK(network != catalogues.end());
  return *network;
}

}  // namespace

std::vector<DetectionSet> detect_boxes(const datasets::SensorStream& stream, ObjectDetector& detector,
                                       std::size_t frames, const DetectionControl& control) {
  std::vector<DetectionSet> sets;
  while (sets.size() < frames && !control.stop()) {
    const std::size_t index = sets.size();
    try {
      sets.push_back(detector.detect(stream.load_frame(index)));
    } catch (const InputError& error) {
      control.skipped(index, error.what());
      sets.push_back(
          {.t = stream.info().frame_times[index], .state = DetectionState::kNone, .detections = {}});
    }
    control.progress(sets.size());
  }
  return sets;
}

bool fetch_detector(const CatalogueDataset& network, const FetchOptions& options,
                    const FetchControl& control) {
  return std::ranges::all_of(network.archives, [&](const datasets::CatalogueArchive& file) {
    const std::optional<LockedDownload> download = download_locked(network, file, options, control);
    if (download) record_first_use(*download, options, control);
    return download.has_value();
  });
}

std::optional<DetectorConfig> downloaded_network(const fs::path& root) {
  const std::vector<CatalogueDataset> catalogues = load_catalogues();
  const DetectorConfig detector = network_config(network_of(catalogues), root).detector;
  for (const std::string& file : {detector.weights, detector.cfg, detector.names}) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) return std::nullopt;
  }
  return detector;
}

bool record_missing_boxes(const InstalledSequence& place, const FetchOptions& options,
                          const FetchControl& control) {
  const fs::path folder = extracted_folder(place);
  if (!fs::is_directory(folder) || fs::exists(folder / "detections.txt")) return true;
  const std::vector<CatalogueDataset> catalogues = load_catalogues();
  const CatalogueDataset& network = network_of(catalogues);
  if (!fetch_detector(network, options, control)) return false;
  const OdometryConfig config = network_config(network, options.root);
  const std::unique_ptr<ObjectDetector> detector =
      make_object_detector(config.detector, {.dynamic_classes = config.dynamic.classes});
  const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(folder);
  const std::size_t frames = stream->info().frame_times.size();
  const datasets::TransferControl step = control.step("detecting objects in " + place.sequence.name);
  const std::vector<DetectionSet> sets = detect_boxes(
      *stream, *detector, frames,
      {.stop = [&] { return datasets::is_stopped(step); },
       .progress = [&](std::size_t done) { datasets::report_progress(step, done, frames); },
       .skipped = [&](std::size_t, const std::string& problem) { datasets::report_line(step, problem); }});
  if (sets.size() < frames) return false;
  write_files(folder, {{"detections.txt", datasets::detections_text(sets)}});
  return true;
}

}  // namespace stillpoint::bench
