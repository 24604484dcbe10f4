// SPDX-License-Identifier: BSD-3-Clause
/// A build of this program that is copied to hosts which lack it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace stillpoint::bench {

struct HostPackage {
  std::filesystem::path tree;  ///< the extracted files, on this machine
  std::string name;            ///< 16 digits that identify the content
  std::string program;         ///< path in the tree
};

/// Extracts a package below a folder, unless that was done before.
/// @param file a Debian package (.deb, scripts/package.sh), whose program requires the libraries that the
/// package depends on; or a root file system (.tar.zst, scripts/image.sh), which contains them, so that the
/// system of the host does not matter
/// @throws InputError if the file is neither, cannot be extracted, or lacks the program
[[nodiscard]] HostPackage extract_package(const std::filesystem::path& file,
                                          const std::filesystem::path& folder,
                                          const std::function<bool()>& stop_requested);

}  // namespace stillpoint::bench
