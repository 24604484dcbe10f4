// SPDX-License-Identifier: BSD-3-Clause
/// Verifies registered sequences and kept archives against the digests of their first use.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/plan/sequence_registry.h"
#include "datasets/download/transfer_control.h"

namespace stillpoint::bench {

enum class VerifiedState { kEqual, kChanged, kMissing };

/// Reads every byte of a registered sequence.
/// @throws InputError if a file cannot be read
[[nodiscard]] VerifiedState verify_sequence(const RegisteredSequence& sequence);

struct VerifiedFile {
  std::string file;
  VerifiedState state = VerifiedState::kEqual;
};

/// Archives that were kept in the folder of downloads.
/// @return those that were read before `control` stopped it
/// @throws InputError if a file cannot be read
[[nodiscard]] std::vector<VerifiedFile> verify_archives(const std::filesystem::path& root,
                                                        const datasets::TransferControl& control);

}  // namespace stillpoint::bench
