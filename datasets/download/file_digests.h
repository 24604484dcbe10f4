// SPDX-License-Identifier: BSD-3-Clause
/// Cryptographic digests of files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "datasets/download/transfer_control.h"

namespace stillpoint::datasets {

struct CryptographicDigests {
  std::uint64_t bytes = 0;
  std::string sha256;  ///< lower-case hexadecimal digits
  std::string md5;     ///< lower-case hexadecimal digits
};

/// Reads a file of any size in blocks.
/// @return empty if stopped
/// @throws InputError if it cannot be read
[[nodiscard]] std::optional<CryptographicDigests> digest_file(const std::filesystem::path& file,
                                                              const TransferControl& control);

}  // namespace stillpoint::datasets
