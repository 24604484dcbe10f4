// SPDX-License-Identifier: BSD-3-Clause
/// Downloads one file from the first of several addresses that provides it, and verifies it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/download/http_transfer.h"
#include "datasets/download/transfer_checks.h"

namespace stillpoint::datasets {

struct DownloadRequest {
  std::filesystem::path file;     ///< its folder exists
  std::vector<std::string> urls;  ///< in the order of preference
  std::uint64_t bytes = 0;        ///< 0 = not known
  std::string sha256;             ///< empty = not known
  std::string md5;                ///< empty = not known
  std::string md5_suffix;         ///< appended to an address: a text with the MD5; empty = none
  TransferSettings settings;
  int attempts = 5;              ///< per address, without progress in between
  double first_backoff_s = 1.0;  ///< doubled after each attempt
};

struct DownloadedFile {
  CryptographicDigests digests;
  std::string url;  ///< empty: the file was there already
};

/// A complete file that exists already is verified and used. FILE.part remains after a failure that another
/// call can continue.
/// @return empty if stopped
/// @throws InputError if no address provides the file, its content differs from the expected one, or the disk
/// is full
[[nodiscard]] std::optional<DownloadedFile> download(const DownloadRequest& request,
                                                     const TransferControl& control);

}  // namespace stillpoint::datasets
