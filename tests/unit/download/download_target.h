// SPDX-License-Identifier: BSD-3-Clause
/// Contents and targets of the download tests.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "datasets/download/download.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {

inline constexpr std::size_t kBytes = 1'000'000;
inline constexpr const char* kEtag = "\"v1\"";

/// Pseudo-random bytes that begin like a gzip file.
inline std::string content_of(unsigned seed, std::size_t bytes = kBytes) {
  std::mt19937 random(seed);
  std::string content(bytes, '\0');
  for (char& byte : content) byte = static_cast<char>(random());
  content.replace(0, 2, "\x1f\x8b");
  return content;
}

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream input(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(input), {}};
}

/// A download to a temporary folder.
struct Target {
  TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "data.tgz";

  [[nodiscard]] DownloadRequest request(const std::vector<std::string>& urls) const {
    return {.file = file,
            .urls = urls,
            .bytes = 0,
            .sha256 = "",
            .md5 = "",
            .md5_suffix = "",
            .settings = {},
            .attempts = 4,
            .first_backoff_s = 0.01};
  }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder.path()), {}));
  }
};

/// The SHA-256 of a content, computed from a file.
inline std::string sha256_of(const std::string& content) {
  const TemporaryFolder folder;
  return digest_file(folder.write("content", content), {})->sha256;
}

}  // namespace stillpoint::datasets
