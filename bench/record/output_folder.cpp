// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/output_folder.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include <fmt/format.h>

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

namespace {

constexpr int kMaxLinks = 40;  // as Linux

/// The file that a path leads to; it need not exist.
fs::path target_of(const fs::path& path) {
  std::error_code error;
  fs::path link = fs::absolute(path);  // weakly_canonical() of a relative path would be relative
  // weakly_canonical() does not follow a link to a file that does not exist.
  for (int i = 0; i < kMaxLinks && fs::is_symlink(link, error) && !fs::exists(link, error); ++i)
    link = link.parent_path() / fs::read_symlink(link, error);
  fs::path target = fs::weakly_canonical(link, error);
  return error ? link.lexically_normal() : target;
}

/// Whether two paths lead to one file or folder: also through links, and before it exists.
bool is_same(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) || target_of(a) == target_of(b);
}

void refuse_inputs(const fs::path& output, const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    if (!input.empty() && is_same(output, input))
      throw InputError(output.string(),
                       "is an input of this command and would be overwritten; choose another output");
  }
}

bool begins_with(const fs::path& file, const std::string& beginning) {
  std::ifstream stream(file, std::ios::binary);
  std::string text(beginning.size(), '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  return stream.gcount() == static_cast<std::streamsize>(text.size()) && text == beginning;
}

bool has_content(const fs::path& file) {
  std::error_code error;
  return fs::exists(file, error) && fs::file_size(file, error) > 0;
}

bool exists_in(const fs::path& folder, const std::string& name) {
  std::error_code error;
  return fs::exists(folder / name, error);
}

}  // namespace

void require_safe_output(const fs::path& file, const OutputRules& rules) {
  refuse_inputs(file, rules.inputs);
  require_regular_file(file);
  if (!has_content(file)) return;
  if (!begins_with(file, rules.beginning))
    throw InputError(file.string(), "exists and is a file of another kind; remove it or choose another name");
  if (!rules.force.value_or(false))
    throw InputError(file.string(), fmt::format("already exists; {} or choose another name",
                                                rules.force ? "replace it with --force" : "remove it"));
}

void write_output(const fs::path& file, const std::string& text, const OutputRules& rules) {
  require_safe_output(file, rules);
  const fs::path target = target_of(file);
  write_files(target.parent_path(), {{target.filename().string(), text}});
}

bool has_earlier_output(const fs::path& folder, const OutputLayout& layout) {
  return std::ranges::any_of(layout.marks, [&](const std::vector<std::string>& set) {
    return std::ranges::all_of(set, [&](const std::string& name) { return exists_in(folder, name); });
  });
}

void require_safe_folder(const fs::path& folder, const OutputLayout& layout,
                         const std::vector<fs::path>& inputs) {
  refuse_inputs(folder, inputs);
  for (const std::string& name : layout.names) refuse_inputs(folder / name, inputs);
  const auto existing =
      std::ranges::find_if(layout.names, [&](const std::string& name) { return exists_in(folder, name); });
  if (existing == layout.names.end() || has_earlier_output(folder, layout)) return;
  throw InputError((folder / *existing).string(),
                   "exists, but not as part of an earlier output; remove it or choose another output folder");
}

}  // namespace stillpoint::bench
