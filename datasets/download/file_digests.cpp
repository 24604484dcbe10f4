// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/file_digests.h"

#include <array>
#include <cstdio>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "core/base/error.h"

namespace stillpoint::datasets {
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
