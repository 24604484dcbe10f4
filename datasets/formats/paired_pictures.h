// SPDX-License-Identifier: BSD-3-Clause
/// Frames of the formats that list colour and depth pictures with stamps of their own.
#pragma once

#include <filesystem>

#include "datasets/sequence_content.h"

namespace stillpoint {

/// Pairs the pictures of two lists, no more than 20 ms apart, into frames stamped by the colour picture; a
/// note says how many colour pictures have no depth and are left out.
/// @throws InputError if a list is missing, empty or unsorted, or nothing pairs
void add_paired_pictures(const std::filesystem::path& color_list, const std::filesystem::path& depth_list,
                         SequenceContent& content, FaultLog& faults);

}  // namespace stillpoint
