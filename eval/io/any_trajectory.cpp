// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/any_trajectory.h"

#include <algorithm>

#include "core/base/error.h"
#include "eval/io/bag_file.h"
#include "eval/io/matrix_files.h"
#include "eval/io/nmea_file.h"
#include "eval/io/openloris_file.h"
#include "eval/io/text_reader.h"
#include "eval/io/text_table.h"

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
  return {std::move(selected->second), file.repairs};
}

}  // namespace

TrajectoryFormat detect_format(std::string_view text) {
  if (is_nmea(text)) return TrajectoryFormat::kNmea;
  RowReader rows(text, "");
  while (const std::optional<TextRow> row = rows.next()) {
    if (row->content.find(':') != std::string_view::npos) return TrajectoryFormat::kOpenloris;
    if (row->fields.size() == 12) return TrajectoryFormat::kKitti;
    const std::string_view first = row->fields.front();
    const bool is_integer =
        std::all_of(first.begin(), first.end(), [](char c) { return c >= '0' && c <= '9'; });
    return is_integer && first.size() >= kMinNanosecondDigits ? TrajectoryFormat::kEuroc
                                                              : TrajectoryFormat::kTum;
  }
  return TrajectoryFormat::kTum;
}

LoadedTrajectory read_trajectory(const TrajectorySource& source) {
  if (is_bag(source.path))
    throw InputError(source.path.string(), "is a bag; name the topic of the poses, e.g. " +
                                               source.path.string() + ":/ground_truth");
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(source.path, ignored);
  if (source.format == TrajectoryFormat::kSevenScenes || (!source.format && is_folder)) {
    return read_seven_scenes(source.path);
  }
  const std::string text = read_text_file(source.path);
  const std::string name = source.path.string();
  switch (source.format.value_or(detect_format(text))) {
    case TrajectoryFormat::kEuroc:
      return parse_euroc(text, name);
    case TrajectoryFormat::kOpenloris:
      return one_sequence(parse_openloris(text, name), source);
    case TrajectoryFormat::kKitti:
      if (source.times.empty()) {
        throw InputError(name, "KITTI poses have no time stamps; specify their file with --times");
      }
      return parse_kitti(text, name, read_text_file(source.times), source.times.string());
    case TrajectoryFormat::kNmea:
      return parse_nmea(text, name);
    default:
      return parse_tum(text, name);
  }
}

}  // namespace stillpoint::eval
