// SPDX-License-Identifier: BSD-3-Clause
#include "bench/fetch/verify_sequences.h"

#include "bench/fetch/data_lock.h"
#include "bench/record/sequence_checksum.h"
#include "datasets/download/file_digests.h"

namespace stillpoint::bench {

namespace fs = std::filesystem;

VerifiedState verify_sequence(const RegisteredSequence& sequence) {
  std::error_code ignored;
  if (!fs::exists(sequence.folder, ignored)) return VerifiedState::kMissing;
  return sequence_checksum(sequence.folder) == sequence.checksum ? VerifiedState::kEqual
                                                                 : VerifiedState::kChanged;
}

std::vector<VerifiedFile> verify_archives(const fs::path& root, const datasets::TransferControl& control) {
  std::vector<VerifiedFile> verified;
  for (const auto& [key, locked] : read_data_lock(root).files) {
    const fs::path dataset = *fs::path(key).begin();
    const fs::path file = root / dataset / "downloads" / fs::path(key).filename();
    if (!fs::exists(file)) continue;
    const auto digests = datasets::digest_file(file, control);
    if (!digests) return verified;
    verified.push_back(
        {file.string(), digests->sha256 == locked.sha256 ? VerifiedState::kEqual : VerifiedState::kChanged});
  }
  return verified;
}

}  // namespace stillpoint::bench
