// SPDX-License-Identifier: BSD-3-Clause
/// Reads the text files of a sequence folder, and decodes its frames.
#pragma once

#include <cstddef>
#include <filesystem>

#include "core/base/fault_log.h"
#include "datasets/formats/sequence_content.h"
#include "datasets/open_sequence.h"

namespace stillpoint::datasets {

/// Reads all text files of a folder and applies the rig file.
/// @throws InputError as `open_sequence`; with a collecting log, faulty rows are recorded there and skipped
[[nodiscard]] SequenceContent read_sequence(const std::filesystem::path& folder, const OpenOptions& options,
                                            FaultLog& faults);

/// Decodes frame `index`; see `SensorStream::load_frame`.
[[nodiscard]] Frame decode_frame(const SequenceContent& content, std::size_t index);

}  // namespace stillpoint::datasets
