// SPDX-License-Identifier: BSD-3-Clause
/// One attempt to transfer the content of an address to a partial file. FILE.part has the bytes so far,
/// FILE.part.state what identifies their content, from the headers of the HTTP response; a later attempt
/// continues there if the content is still the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "datasets/download/transfer_checks.h"

namespace stillpoint::datasets {

/// What a server states about the content of an address (RFC 9110, sections 8.8 and 14.4).
struct ContentState {
  std::string url;
  std::string etag;
  std::string last_modified;
  std::uint64_t total = 0;  ///< bytes; 0 = not stated
};

/// Whether two responses may be parts of the same content: what both state must be equal, and they must have
/// at least one statement in common.
[[nodiscard]] bool is_same_content(const ContentState& a, const ContentState& b);

/// Writes the bytes of a download, in order.
class PartialFile {
 public:
  /// Opens or creates FILE.part. Existing bytes are kept if their state is readable, else removed.
  /// @throws InputError if it cannot be opened
  explicit PartialFile(const std::filesystem::path& file);
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] const ContentState& state() const { return state_; }
  [[nodiscard]] const std::filesystem::path& path() const { return part_; }

  /// Removes all bytes, and remembers the state of the content that will be written.
  /// @throws InputError if the state cannot be written
  void restart(const ContentState& state);

  /// @throws InputError if the disk is full
  void append(std::string_view bytes);

  /// Waits until all bytes are on the disk, and gives them the name FILE.
  /// @throws InputError if that fails
  void complete();

 private:
  std::filesystem::path file_;
  std::filesystem::path part_;
  std::filesystem::path state_file_;
  ContentState state_;
  std::uint64_t bytes_ = 0;
  int descriptor_ = -1;
};

/// `Content-Range: bytes first-last/total` (RFC 9110, section 14.4).
struct ContentRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  std::uint64_t total = 0;  ///< 0 = not stated ("*")
};

/// Empty if malformed or inconsistent.
[[nodiscard]] std::optional<ContentRange> parse_content_range(std::string_view text);

/// The headers of a response that a download uses.
struct ResponseHeaders {
  std::string etag;  ///< empty if weak: a weak validator does not identify bytes
  std::string last_modified;
  std::optional<ContentRange> range;
  std::uint64_t content_length = 0;  ///< 0 = not stated
};

/// `headers` with one more line. A status line begins the headers of the next response, e.g. after a
/// redirect.
[[nodiscard]] ResponseHeaders with_header_line(ResponseHeaders headers, std::string_view line);

/// Proxies are those of the environment (http_proxy, https_proxy, all_proxy, no_proxy).
struct TransferSettings {
  std::string user_agent;  ///< empty: the name of this program
  std::string token;       ///< sent as `Authorization: Bearer`, to the first host only; empty = none
  int connect_timeout_s = 30;
  int stall_timeout_s = 30;  ///< a transfer below 1 kB/s for this time is ended
  int max_redirects = 10;
};

/// What is transferred.
struct TransferSource {
  std::string url;
  std::uint64_t expected_bytes = 0;  ///< content of another size is rejected; 0 = any
};

enum class TransferOutcome {
  kComplete,
  kStopped,    ///< by `TransferControl::stop`; the next attempt continues
  kTemporary,  ///< another attempt may succeed
  kPermanent,  ///< the address does not provide the file
  kDenied,     ///< the address does not provide it to this user
};

struct TransferResult {
  TransferOutcome outcome = TransferOutcome::kPermanent;
  std::string problem;         ///< for messages; empty if complete or stopped
  double retry_after_s = 0.0;  ///< requested by the server
};

/// Continues at the end of the partial file if the server confirms by status 206, Content-Range, ETag,
/// Last-Modified and size that the content is the same; begins again otherwise.
/// @throws InputError if the disk is full, before the transfer where the size is known
[[nodiscard]] TransferResult transfer(const TransferSource& source, PartialFile& part,
                                      const TransferSettings& settings, const TransferControl& control);

}  // namespace stillpoint::datasets
