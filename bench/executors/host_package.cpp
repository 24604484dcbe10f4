// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/host_package.h"

#include <fstream>
#include <vector>

#include "bench/executors/tool.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlockBytes = 1 << 20;

std::uint64_t file_hash(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw InputError(file.string(), "cannot be read; write it with scripts/image.sh or scripts/package.sh");
  std::string block(kBlockBytes, '\0');
  std::uint64_t hash = 0;
  while (stream.read(block.data(), kBlockBytes) || stream.gcount() > 0)
    hash = content_hash({block.data(), static_cast<std::size_t>(stream.gcount())}, hash);
  return hash;
}

ToolCall extraction(const fs::path& file, const fs::path& tree) {
  if (file.extension() == ".deb") return {.program = "dpkg-deb", .arguments = {"--extract", file, tree}};
  return {.program = "tar",
          .arguments = {"--extract", "--zstd", "--no-same-owner", "--file", file, "--directory", tree}};
}

}  // namespace

HostPackage extract_package(const fs::path& file, const fs::path& folder,
                            const std::function<bool()>& stop_requested) {
  const bool is_deb = file.extension() == ".deb";
  if (!is_deb && !file.string().ends_with(".tar.zst"))
    throw InputError(file.string(), "is neither a Debian package (.deb) nor a root file system (.tar.zst)");
  HostPackage package{.tree = {},
                      .name = hash_text(file_hash(file)),
                      .program = is_deb ? "usr/bin/stillpoint" : "stillpoint"};
  package.tree = folder / package.name;
  if (fs::exists(package.tree)) return package;
  const fs::path incomplete = folder / (package.name + ".incomplete");
  fs::remove_all(incomplete);
  fs::create_directories(incomplete);
  ToolCall call = extraction(file, incomplete);
  call.stop_requested = stop_requested;
  const ToolResult result = call_tool(call);
  if (stop_requested && stop_requested()) return package;
  if (result.exit_code != 0) throw InputError(file.string(), "cannot be extracted: " + result.messages);
  if (!fs::exists(incomplete / package.program))
    throw InputError(file.string(),
                     "lacks /" + package.program + "; write it with scripts/image.sh or scripts/package.sh");
  fs::rename(incomplete, package.tree);
  return package;
}

}  // namespace stillpoint::bench
