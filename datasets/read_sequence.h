// SPDX-License-Identifier: BSD-3-Clause
/// Reads the text files of a sequence folder, and decodes its frames.
#pragma once

#include <cstddef>
#include <filesystem>

#include "core/base/error.h"
#include "datasets/formats/formats.h"
#include "datasets/open_sequence.h"

namespace stillpoint::datasets {

/// Reads all text files of a folder and applies the rig file.
/// @throws InputError as `open_sequence`; with a collecting log, faulty rows are recorded there and skipped
[[nodiscard]] SequenceContent read_sequence(const std::filesystem::path& folder, const OpenOptions& options,
                                            FaultLog& faults);

/// When to decode a color image: with its frame, or when it is used.
enum class ColorDecoding { kWithFrame, kDeferred };

/// Decodes frame `index`; see `SensorStream::load_frame`. A change of the decoded gray or depth values
/// requires another `kDecodingVersion`.
/// @param color with `kDeferred`, the frame must not outlive `content`
[[nodiscard]] Frame decode_frame(const SequenceContent& content, std::size_t index,
                                 ColorDecoding color = ColorDecoding::kWithFrame);

/// Decodes the color image of frame `index`; empty if it is gray.
/// @throws InputError as `decode_frame`
[[nodiscard]] cv::Mat decode_color(const SequenceContent& content, std::size_t index);

}  // namespace stillpoint::datasets
