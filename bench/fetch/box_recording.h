// SPDX-License-Identifier: BSD-3-Clause
/// Records the boxes of a detection network beside the images of a sequence.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "bench/fetch/data_lock.h"
#include "bench/fetch/fetch_sequences.h"
#include "core/config/detector_config.h"
#include "core/detector/object_detector.h"
#include "datasets/catalogue/catalogue.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::bench {

/// `CatalogueDataset::layout` of a network: the files of its sequence are weights, cfg and names, in this
/// order.
inline constexpr std::string_view kDetectorLayout = "detector";

/// Calls of `detect_boxes` per frame.
struct DetectionControl {
  std::function<bool()> stop;                                                  ///< ends the detection
  std::function<void(std::size_t done)> progress;                              ///< number of complete frames
  std::function<void(std::size_t frame, const std::string& problem)> skipped;  ///< its image is unreadable
};

/// The boxes of the first frames of a sequence; state `kNone` of frames whose image cannot be read.
/// @return fewer than `frames` if stopped
[[nodiscard]] std::vector<DetectionSet> detect_boxes(const datasets::SensorStream& stream,
                                                     ObjectDetector& detector, std::size_t frames,
                                                     const DetectionControl& control);

/// Downloads the files of a network. @return false if stopped
/// @throws InputError as `datasets::download`
[[nodiscard]] bool fetch_detector(const datasets::CatalogueDataset& network, const FetchOptions& options,
                                  const FetchControl& control);

/// The network of the catalogue, if `fetch_detector` has downloaded it.
/// @param root folder of downloads
/// @return the default detector with the files of the network; nullopt unless all of them exist
[[nodiscard]] std::optional<DetectorConfig> downloaded_network(const std::filesystem::path& root);

/// Writes detections.txt of an extracted sequence that has none, with the network of the catalogue, which is
/// downloaded first. Does nothing for files, i.e. bags.
/// @return false if stopped
/// @throws InputError as `fetch_detector`, and if the network or the sequence cannot be read
[[nodiscard]] bool record_missing_boxes(const InstalledSequence& place, const FetchOptions& options,
                                        const FetchControl& control);

}  // namespace stillpoint::bench
