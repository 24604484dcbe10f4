// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/analysis/import/evo_import.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/cli/analysis/import/imported_runs.h"
#include "bench/model/json_problem.h"
#include "bench/model/metrics.h"
#include "bench/process/temporary_path.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/download/archive_extraction.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The files of an archive, in a temporary folder that is removed with this object.
class ExtractedArchive {
 public:
  explicit ExtractedArchive(const fs::path& archive) {
    static_cast<void>(datasets::extract_archive(archive, folder_.path(), {}, {}));
  }

  /// @throws InputError if there is no such file
  [[nodiscard]] std::string text(const std::string& name, const fs::path& archive) const {
    if (!fs::exists(folder_.path() / name))
      throw InputError(archive.string(),
                       "has no " + name + "; it is no result of evo, as written by `evo_ape --save_results`");
    return eval::read_text_file(folder_.path() / name);
  }

 private:
  TemporaryPath folder_{TemporaryPath::Kind::kFolder, "evo"};
};

/// A vector of doubles as numpy.save writes it: "\x93NUMPY", version, length of the header, a header in
/// Python syntax, data. https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
std::vector<double> numbers_of(const std::string& bytes, const std::string& place) {
  constexpr std::size_t kHeaderBegin = 10;  // of version 1, with a length of two bytes
  const bool is_known = bytes.size() >= kHeaderBegin && bytes.starts_with("\x93NUMPY\x01");
  const std::size_t length =
      is_known ? static_cast<unsigned char>(bytes[8]) + 256U * static_cast<unsigned char>(bytes[9]) : 0;
  const std::string header = is_known ? bytes.substr(kHeaderBegin, length) : "";
  const std::size_t begin = kHeaderBegin + length;
  if (header.find("'<f8'") == std::string::npos || bytes.size() < begin ||
      (bytes.size() - begin) % sizeof(double))
    throw InputError(place, "is no file of numpy with 64-bit numbers");
  std::vector<double> numbers((bytes.size() - begin) / sizeof(double));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data() + begin, bytes.size() - begin);
  return numbers;
}

/// What evo writes for --pose_relation trans_part or angle_deg. Labels alone are ambiguous: that of
/// point_distance is also "RPE (m)".
struct EvoMetric {
  std::string_view label;
  std::string_view title;  ///< begin
  std::string_view id;
};
constexpr std::array<EvoMetric, 4> kEvoMetrics = {
    {{"APE (m)", "APE w.r.t. translation part", metric_id::kAte},
     {"APE (deg)", "APE w.r.t. rotation angle", metric_id::kAteRotation},
     {"RPE (m)", "RPE w.r.t. translation part", metric_id::kRpeTranslationPerDelta},
     {"RPE (deg)", "RPE w.r.t. rotation angle", metric_id::kRpeRotationPerDelta}}};

std::string_view metric_of(const std::string& label, const std::string& title, const std::string& place) {
  for (const EvoMetric& metric : kEvoMetrics) {
    if (label == metric.label && title.starts_with(metric.title)) return metric.id;
  }
  throw InputError(place, "has the label \"" + label + "\" and the title \"" +
                              title.substr(0, title.find('\n')) +
                              "\"; expected APE or RPE, in m or deg, of evo's --pose_relation trans_part or "
                              "angle_deg");
}

/// The first specific name in a path, from its end; empty if there is none.
/// @param excluded a name that is not specific
std::string specific_name(const fs::path& file, const std::string& excluded) {
  constexpr std::array<std::string_view, 22> kGeneralNames = {
      "",          ".",        "..",        "groundtruth", "ground_truth",     "gt",
      "reference", "ref",      "data",      "mav0",        "trajectory",       "state_groundtruth_estimate0",
      "traj",      "estimate", "estimated", "est",         "cameratrajectory", "keyframetrajectory",
      "poses",     "pose",     "result",    "results"};
  for (fs::path path = file.relative_path(); !path.empty(); path = path.parent_path()) {
    const std::string name = path == file.relative_path() ? path.stem().string() : path.filename().string();
    std::string lower = name;
    std::ranges::transform(lower, lower.begin(), [](unsigned char letter) { return std::tolower(letter); });
    if (name != excluded && std::ranges::find(kGeneralNames, lower) == kGeneralNames.end()) return name;
  }
  return "";
}

/// The names given, else those of the paths of the result.
EvoNames names_of(const Json& info, EvoNames names, const std::string& place) {
  const auto require = [&](std::string& name, const char* key, const char* option) {
    const std::string path = info.at(key).get<std::string>();
    if (name.empty()) name = specific_name(path, names.sequence);
    if (name.empty())
      throw InputError(place,
                       fmt::format("names no {0}: its {1} is \"{2}\"; pass --{0} NAME", option, key, path));
  };
  require(names.sequence, "ref_name", "sequence");
  require(names.system, "est_name", "system");
  return names;
}

/// The title in one line.
std::string protocol_of(std::string title) {
  for (std::size_t end = title.find('\n'); end != std::string::npos; end = title.find('\n', end))
    title.replace(end, 1, ", ");
  return "evo: " + title;
}

/// @throws InputError if it is not that of the errors
void require_rmse(double rmse, const std::vector<double>& errors, const std::string& place) {
  double sum = 0.0;
  for (const double error : errors) sum += error * error;
  const double expected = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(errors.size(), 1)));
  if (!errors.empty() && std::abs(expected - rmse) <= 1e-6 * std::max(1.0, expected)) return;
  throw InputError(
      place, fmt::format("stats.json states an RMSE of {:g}, the {} errors of error_array.npy have {:g}",
                         rmse, errors.size(), expected));
}

}  // namespace

bool is_zip_file(const fs::path& file) {
  if (!fs::is_regular_file(file)) return false;  // a pipe would be waited for
  std::ifstream stream(file, std::ios::binary);
  std::string begin(4, '\0');
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin == std::string("PK\x03\x04");
}

MergeReport import_evo(const fs::path& file, const fs::path& store, const EvoNames& given) {
  const std::string place = file.string();
  const ExtractedArchive archive(file);
  try {
    const Json info = Json::parse(archive.text("info.json", file));
    const double rmse = Json::parse(archive.text("stats.json", file)).at("rmse").get<double>();
    require_rmse(rmse, numbers_of(archive.text("error_array.npy", file), place), place);
    const std::string label = info.at("label").get<std::string>();
    const std::string title = info.at("title").get<std::string>();
    const std::string_view id = metric_of(label, title, place);
    const Metric metric{.name = std::string(id),
                        .protocol = protocol_of(title),
                        .unit = std::string(find_metric(id)->unit),
                        .value = rmse};
    const EvoNames names = names_of(info, given, place);
    RunIdentity identity = imported_identity();
    identity.system = names.system;
    identity.variant = names.system;
    identity.sequence = names.sequence;
    identity.sequence_id = "evo-" + hash_text(content_hash(names.sequence));
    identity.config_hash = hash_text(content_hash(label + "\n" + title));
    return add_imported(store, {{std::move(identity), {.metrics = {metric}}}});
  } catch (const Json::exception& error) {
    throw InputError(place, "is no result of evo: " + json_problem(error));
  }
}

}  // namespace stillpoint::bench
