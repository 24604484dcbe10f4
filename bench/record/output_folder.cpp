// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/output_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include <unistd.h>

#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

InputError cannot_make(const fs::path& folder, const std::error_code& error) {
  return {folder.string(), "cannot be created: " + error.message() + "; choose another output folder"};
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw cannot_make(folder, error);
}

/// Temporary files of one group; removed on destruction unless renamed.
class TemporaryFiles {
 public:
  explicit TemporaryFiles(fs::path folder) : folder_(std::move(folder)) {}
  ~TemporaryFiles() {
    std::error_code ignored;
    for (const std::string& name : names_) fs::remove(temporary(name), ignored);
  }
  TemporaryFiles(const TemporaryFiles&) = delete;
  TemporaryFiles& operator=(const TemporaryFiles&) = delete;

  void write(const OutputFile& file) {
    names_.push_back(file.name);
    errno = 0;
    std::ofstream stream(temporary(file.name), std::ios::binary);
    stream << file.text;
    stream.close();
    if (stream) return;
    const std::string cause = errno == 0 ? "write error" : std::strerror(errno);
    throw InputError((folder_ / file.name).string(),
                     "cannot be written: " + cause + "; free space or choose another output folder");
  }

  void rename_all() {
    for (const std::string& name : names_) fs::rename(temporary(name), folder_ / name);
    names_.clear();
  }

 private:
  [[nodiscard]] fs::path temporary(const std::string& name) const {
    return folder_ / ("." + name + "." + std::to_string(getpid()));
  }

  fs::path folder_;
  std::vector<std::string> names_;
};

}  // namespace

void require_writable(const fs::path& folder) {
  fs::path existing = fs::absolute(folder).lexically_normal();
  while (!fs::exists(existing)) existing = existing.parent_path();
  if (!fs::is_directory(existing))
    throw cannot_make(folder, std::make_error_code(std::errc::not_a_directory));
  TemporaryFiles(existing).write({"probe", "x"});
}

std::string folder_name(std::string variant) {
  std::replace(variant.begin(), variant.end(), '/', '-');
  return variant;
}

void write_files(const fs::path& folder, const std::vector<OutputFile>& files) {
  make_folder(folder);
  TemporaryFiles temporary(folder);
  for (const OutputFile& file : files) temporary.write(file);
  temporary.rename_all();
}

}  // namespace stillpoint::bench
