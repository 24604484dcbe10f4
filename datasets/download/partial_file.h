// SPDX-License-Identifier: BSD-3-Clause
/// A file that is being downloaded: FILE.part, and FILE.part.state with what identifies its content.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

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

}  // namespace stillpoint::datasets
