// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/output_guard.h"

#include <algorithm>
#include <fstream>

#include "bench/record/output_folder.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

void require_safe_output(const fs::path& file, const OutputRules& rules) {
  refuse_inputs(file, rules.inputs);
  require_regular_file(file);
  if (!has_content(file)) return;
  if (!begins_with(file, rules.beginning))
    throw InputError(file.string(), "exists and is a file of another kind; remove it or choose another name");
  if (!rules.force)
    throw InputError(file.string(), "already exists; replace it with --force or choose another name");
}

void write_output(const fs::path& file, const std::string& text, const OutputRules& rules) {
  require_safe_output(file, rules);
  const fs::path target = target_of(file);
  write_files(target.parent_path(), {{target.filename().string(), text}});
}

void require_safe_folder(const fs::path& folder, const OutputLayout& layout,
                         const std::vector<fs::path>& inputs) {
  refuse_inputs(folder, inputs);
  const auto exists = [&](const std::string& name) {
    std::error_code error;
    return fs::exists(folder / name, error);
  };
  const bool has_marks = std::ranges::any_of(
      layout.marks, [&](const std::vector<std::string>& set) { return std::ranges::all_of(set, exists); });
  for (const std::string& name : layout.names) refuse_inputs(folder / name, inputs);
  const auto existing = std::ranges::find_if(layout.names, exists);
  if (existing == layout.names.end() || has_marks) return;
  throw InputError((folder / *existing).string(),
                   "exists, but not as part of an earlier output; remove it or choose another output folder");
}

}  // namespace stillpoint::bench
