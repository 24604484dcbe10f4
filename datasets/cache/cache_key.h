// SPDX-License-Identifier: BSD-3-Clause
/// Key of a frame cache file: everything that determines the decoded images.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "datasets/formats/sequence_content.h"

namespace stillpoint::datasets {

/// Version of the decoding: of gray values, registration and depth. Increase it whenever `decode_frame`
/// returns other images for the same files.
constexpr std::uint64_t kDecodingVersion = 1;

/// Hash of the digests, the calibration by which images are decoded and registered, and the versions of
/// decoder and file format. Frame times and inertial data are not part of it: they are read from the sequence
/// in every run.
[[nodiscard]] std::uint64_t cache_key(const SequenceContent& content, std::span<const FrameDigest> frames);

/// The cache file of a key.
[[nodiscard]] std::filesystem::path frame_file(const std::filesystem::path& cache, std::uint64_t key);

}  // namespace stillpoint::datasets
