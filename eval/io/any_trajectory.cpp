// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/any_trajectory.h"

#include <algorithm>
#include <vector>

#include "core/base/error.h"
#include "eval/io/euroc_file.h"
#include "eval/io/matrix_files.h"
#include "eval/io/openloris_file.h"
#include "eval/io/text_reader.h"

namespace stillpoint::eval {
namespace {

constexpr std::size_t kMinNanosecondDigits = 16;  // 10^15 ns are 11 days; 10^15 s would be 30 million years

LoadedTrajectory one_sequence(OpenlorisFile file, const TrajectorySource& source) {
  auto selected = file.sequences.begin();
  if (source.sequence != 0) {
    selected = file.sequences.find(source.sequence);
    if (selected == file.sequences.end()) {
      throw InputError(source.path.string(), "has no sequence " + std::to_string(source.sequence));
    }
  } else if (file.sequences.size() > 1) {
    throw InputError(source.path.string(), "contains " + std::to_string(file.sequences.size()) +
                                               " sequences; select one with --seq");
  }
  return {std::move(selected->second), file.skipped_rows};
}

}  // namespace

std::string detect_format(std::string_view text) {
  LineReader lines(text);
  std::vector<std::string_view> fields;
  while (const std::optional<std::string_view> line = lines.next()) {
    split_fields(*line, fields);
    if (fields.empty() || fields.front().front() == '#') continue;
    if (line->find(':') != std::string_view::npos) return "openloris";
    if (fields.size() == 12) return "kitti";
    const std::string_view first = fields.front();
    const bool is_integer =
        std::all_of(first.begin(), first.end(), [](char c) { return c >= '0' && c <= '9'; });
    return is_integer && first.size() >= kMinNanosecondDigits ? "euroc" : "tum";
  }
  return "tum";
}

LoadedTrajectory read_trajectory(const TrajectorySource& source) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(source.path, ignored);
  if (source.format == "7scenes" || (source.format.empty() && is_folder))
    return read_seven_scenes(source.path);
  const std::string text = read_text_file(source.path);
  const std::string name = source.path.string();
  const std::string format = source.format.empty() ? detect_format(text) : source.format;
  if (format == "tum") return parse_tum(text, name);
  if (format == "euroc") return parse_euroc(text, name);
  if (format == "openloris") return one_sequence(parse_openloris(text, name), source);
  if (format == "kitti") {
    if (source.times.empty())
      throw InputError(name, "KITTI poses have no time stamps; specify their file with --times");
    return parse_kitti(text, name, read_text_file(source.times), source.times.string());
  }
  throw InputError("--format " + format,
                   "unknown format; expected one of: tum, euroc, kitti, openloris, 7scenes");
}

}  // namespace stillpoint::eval
