// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/disk_space.h"

#include <fmt/format.h>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {
constexpr std::uint64_t kReserveBytes = 64'000'000;
constexpr double kBytesPerMb = 1e6;
}  // namespace

void require_disk_space(const std::filesystem::path& folder, std::uint64_t bytes) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder, error);
  if (error || space.available >= bytes + kReserveBytes) return;
  throw InputError(
      folder.string(),
      fmt::format("has {:.0f} MB of free disk space, required are {:.0f} MB; free some, or choose "
                  "another folder with --to",
                  static_cast<double>(space.available) / kBytesPerMb,
                  static_cast<double>(bytes + kReserveBytes) / kBytesPerMb));
}

}  // namespace stillpoint::datasets
