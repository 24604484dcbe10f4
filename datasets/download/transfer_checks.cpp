// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/transfer_checks.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <openssl/evp.h>

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

namespace {

constexpr std::size_t kDigestBytes = 1U << 20U;

/// Incremental digest of OpenSSL.
class Digest {
 public:
  explicit Digest(const EVP_MD* algorithm) : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    STILLPOINT_CHECK(context_ != nullptr && EVP_DigestInit_ex(context_.get(), algorithm, nullptr) == 1);
  }
  void add(const void* bytes, std::size_t count) {
    STILLPOINT_CHECK(EVP_DigestUpdate(context_.get(), bytes, count) == 1);
  }
  [[nodiscard]] std::string text() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    STILLPOINT_CHECK(EVP_DigestFinal_ex(context_.get(), digest.data(), &size) == 1);
    std::string hex;
    for (unsigned int i = 0; i < size; ++i) hex += fmt::format("{:02x}", digest.at(i));
    return hex;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::optional<CryptographicDigests> digest_file(const std::filesystem::path& file,
                                                const TransferControl& control) {
  std::error_code error;
  const std::uint64_t total = std::filesystem::file_size(file, error);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> input(std::fopen(file.c_str(), "rbe"), std::fclose);
  if (input == nullptr || error) throw InputError(file.string(), "cannot be read");
  Digest sha256(EVP_sha256());
  Digest md5(EVP_md5());
  std::vector<unsigned char> block(kDigestBytes);
  CryptographicDigests digests;
  while (const std::size_t count = std::fread(block.data(), 1, block.size(), input.get())) {
    if (is_stopped(control)) return std::nullopt;
    sha256.add(block.data(), count);
    md5.add(block.data(), count);
    digests.bytes += count;
    report_progress(control, digests.bytes, total);
  }
  if (std::ferror(input.get()) != 0) throw InputError(file.string(), "cannot be read to its end");
  digests.sha256 = sha256.text();
  digests.md5 = md5.text();
  return digests;
}

}  // namespace stillpoint::datasets
