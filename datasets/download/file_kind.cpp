// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/file_kind.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

constexpr std::size_t kHeadBytes = 512;

/// Magic bytes of an extension.
struct FileKind {
  std::string_view extension;
  std::string_view kind;  ///< for messages
  std::size_t offset = 0;
  std::string_view magic;
};
constexpr std::array kKinds{
    FileKind{".tgz", "gzip file", 0, "\x1f\x8b"},  FileKind{".gz", "gzip file", 0, "\x1f\x8b"},
    FileKind{".bz2", "bzip2 file", 0, "BZh"},      FileKind{".xz", "xz file", 0, "\xfd\x37zXZ"},
    FileKind{".zip", "zip archive", 0, "PK"},      FileKind{".7z", "7z archive", 0, "7z\xbc\xaf\x27\x1c"},
    FileKind{".tar", "tar archive", 257, "ustar"}, FileKind{".bag", "ROS bag", 0, "#ROSBAG"}};
constexpr std::array kArchives{".tar", ".tgz", ".tar.gz", ".tar.bz2", ".tar.xz", ".zip", ".7z"};

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return std::tolower(c); });
  return result;
}

}  // namespace

bool is_html(std::string_view first_bytes) {
  const std::size_t begin = first_bytes.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (begin == std::string_view::npos) return false;
  const std::string text = lower_case(first_bytes.substr(begin, kHeadBytes));
  return text.starts_with("<!doctype") || text.starts_with("<html") || text.starts_with("<?xml") ||
         text.starts_with("<head");
}

bool has_archive_name(const std::filesystem::path& file) {
  const std::string name = lower_case(file.filename().string());
  return std::ranges::any_of(kArchives,
                             [&](std::string_view extension) { return name.ends_with(extension); });
}

std::string content_problem(const std::filesystem::path& file, const std::string& name) {
  std::array<char, kHeadBytes> head{};
  std::ifstream input(file, std::ios::binary);
  if (!input) throw InputError(file.string(), "cannot be read");
  input.read(head.data(), head.size());
  const std::string_view bytes(head.data(), static_cast<std::size_t>(input.gcount()));
  const std::string lower = lower_case(name);
  for (const FileKind& kind : kKinds) {
    if (!lower.ends_with(kind.extension)) continue;
    const bool matches = bytes.size() >= kind.offset && bytes.substr(kind.offset).starts_with(kind.magic);
    if (matches) return "";
    return is_html(bytes) ? "is an HTML page, not a " + std::string(kind.kind)
                          : "is not a " + std::string(kind.kind);
  }
  return "";
}

}  // namespace stillpoint::datasets
