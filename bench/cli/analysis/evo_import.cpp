// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/analysis/evo_import.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/json_problem.h"
#include "bench/model/metrics.h"
#include "bench/store/store_writer.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/download/archive_extraction.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The files of an archive, in a folder that is removed with this object.
class ExtractedArchive {
 public:
  explicit ExtractedArchive(const fs::path& archive)
      : folder_(fs::temp_directory_path() / fmt::format("stillpoint-evo-{}", getpid())) {
    fs::remove_all(folder_);
    static_cast<void>(datasets::extract_archive(archive, folder_, {}, {}));
  }
  ~ExtractedArchive() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  ExtractedArchive(const ExtractedArchive&) = delete;
  ExtractedArchive& operator=(const ExtractedArchive&) = delete;

  /// @throws InputError if there is no such file
  [[nodiscard]] std::string text(const std::string& name, const fs::path& archive) const {
    if (!fs::exists(folder_ / name))
      throw InputError(archive.string(),
                       "has no " + name + "; it is no result of evo, as written by `evo_ape --save_results`");
    return eval::read_text_file(folder_ / name);
  }

 private:
  fs::path folder_;
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

/// The metric that a label names: "APE (m)", "RPE (deg)".
std::string_view metric_of(const std::string& label, const std::string& place) {
  if (label == "APE (m)") return metric_id::kAte;
  if (label == "APE (deg)") return metric_id::kAteRotation;
  if (label == "RPE (m)") return metric_id::kRpeTranslationPerDelta;
  if (label == "RPE (deg)") return metric_id::kRpeRotationPerDelta;
  throw InputError(place, "has the label \"" + label +
                              "\"; expected one of APE (m), APE (deg), RPE (m), RPE (deg): evo's "
                              "--pose_relation trans_part or angle_deg");
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

MergeReport import_evo(const fs::path& file, const fs::path& store) {
  const ExtractedArchive archive(file);
  try {
    const Json info = Json::parse(archive.text("info.json", file));
    const double rmse = Json::parse(archive.text("stats.json", file)).at("rmse").get<double>();
    require_rmse(rmse, numbers_of(archive.text("error_array.npy", file), file.string()), file.string());
    const std::string_view metric = metric_of(info.at("label").get<std::string>(), file.string());
    const std::string estimate = fs::path(info.at("est_name").get<std::string>()).stem().string();
    const std::string reference = info.at("ref_name").get<std::string>();
    const RunIdentity identity{.system = estimate,
                               .variant = estimate,
                               .sequence = fs::path(reference).stem().string(),
                               .sequence_id = "evo-" + hash_text(content_hash(reference)),
                               .config_hash = hash_text(content_hash(eval::read_text_file(file))),
                               .build = "imported",
                               .mode = "external"};
    StoreWriter writer(store);
    if (writer.is_done(run_key(identity))) return {.added = 0, .present = 1};
    if (writer.acquire(identity) != RunLease::kGranted)
      throw InputError(store.string(), "is written by another process; try again");
    writer.finish(identity, {.metrics = {{.name = std::string(metric),
                                          .protocol = protocol_of(info.at("title").get<std::string>()),
                                          .unit = std::string(find_metric(metric)->unit),
                                          .value = rmse}}});
    return {.added = 1, .present = 0};
  } catch (const Json::exception& error) {
    throw InputError(file.string(), "is no result of evo: " + json_problem(error));
  }
}

}  // namespace stillpoint::bench
