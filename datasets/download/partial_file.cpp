// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/partial_file.h"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kFileMode = 0666;

/// The state as lines: address, ETag, Last-Modified, bytes. HTTP headers have no line breaks.
std::string state_text(const ContentState& state) {
  return state.url + "\n" + state.etag + "\n" + state.last_modified + "\n" + std::to_string(state.total) +
         "\n";
}

/// An empty state if the file is not readable as one.
ContentState read_state(const fs::path& file) {
  std::ifstream input(file);
  ContentState state;
  std::string total;
  if (!std::getline(input, state.url) || !std::getline(input, state.etag) ||
      !std::getline(input, state.last_modified) || !std::getline(input, total))
    return {};
  const auto [end, error] = std::from_chars(total.data(), total.data() + total.size(), state.total);
  return error == std::errc{} && end == total.data() + total.size() ? state : ContentState{};
}

[[noreturn]] void throw_write_error(const fs::path& file, int error) {
  throw InputError(file.string(), std::string("cannot be written: ") + std::strerror(error) +
                                      "; free disk space or choose another folder with --to, then run the "
                                      "command again: it continues");
}

}  // namespace

bool is_same_content(const ContentState& a, const ContentState& b) {
  if (!a.etag.empty() && !b.etag.empty() && a.etag != b.etag) return false;
  if (!a.last_modified.empty() && !b.last_modified.empty() && a.last_modified != b.last_modified)
    return false;
  if (a.total != 0 && b.total != 0 && a.total != b.total) return false;
  return (!a.etag.empty() && a.etag == b.etag) ||
         (!a.last_modified.empty() && a.last_modified == b.last_modified) ||
         (a.total != 0 && a.total == b.total);
}

PartialFile::PartialFile(const fs::path& file)
    : file_(file), part_(file.string() + ".part"), state_file_(file.string() + ".part.state") {
  descriptor_ = open(part_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kFileMode);
  if (descriptor_ < 0) throw_write_error(part_, errno);
  state_ = read_state(state_file_);
  if (state_.url.empty()) {
    if (ftruncate(descriptor_, 0) != 0) throw_write_error(part_, errno);
    return;
  }
  const off_t end = lseek(descriptor_, 0, SEEK_END);
  if (end < 0) throw_write_error(part_, errno);
  bytes_ = static_cast<std::uint64_t>(end);
}

PartialFile::~PartialFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

void PartialFile::restart(const ContentState& state) {
  if (ftruncate(descriptor_, 0) != 0 || lseek(descriptor_, 0, SEEK_SET) != 0) throw_write_error(part_, errno);
  bytes_ = 0;
  state_ = state;
  std::ofstream output(state_file_, std::ios::binary);
  output << state_text(state) << std::flush;
  if (!output) throw_write_error(state_file_, ENOSPC);
}

void PartialFile::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw_write_error(part_, errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
    bytes_ += static_cast<std::uint64_t>(count);
  }
}

void PartialFile::complete() {
  if (fsync(descriptor_) != 0) throw_write_error(part_, errno);
  std::error_code error;
  fs::rename(part_, file_, error);
  if (error) throw InputError(file_.string(), "cannot be written: " + error.message());
  fs::remove(state_file_, error);
}

}  // namespace stillpoint::datasets
