// SPDX-License-Identifier: BSD-3-Clause
/// Frames of the formats that list color and depth images with separate timestamps.
#pragma once

#include <filesystem>

#include "datasets/sequence_content.h"

namespace stillpoint::datasets {

/// Pairs the images of two lists, at most 20 ms apart, into frames with the timestamp of the color image.
/// Color images without depth are dropped, and their number is added to the notes.
/// @throws InputError if a list is missing, empty or unsorted, or there are no pairs
void add_paired_images(const std::filesystem::path& color_list, const std::filesystem::path& depth_list,
                       SequenceContent& content, FaultLog& faults);

}  // namespace stillpoint::datasets
