// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/ply_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <set>
#include <sstream>
#include <string_view>
#include <tuple>

#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::eval {
namespace {

static_assert(std::endian::native == std::endian::little);

struct PlyType {
  std::string_view name;
  std::string_view other_name;
  std::size_t bytes = 0;
  double (*read)(const char*) = nullptr;
};

template <class Number>
double read_number(const char* bytes) {
  Number value{};
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

constexpr std::array<PlyType, 8> kPlyTypes{{{"char", "int8", 1, read_number<std::int8_t>},
                                            {"uchar", "uint8", 1, read_number<std::uint8_t>},
                                            {"short", "int16", 2, read_number<std::int16_t>},
                                            {"ushort", "uint16", 2, read_number<std::uint16_t>},
                                            {"int", "int32", 4, read_number<std::int32_t>},
                                            {"uint", "uint32", 4, read_number<std::uint32_t>},
                                            {"float", "float32", 4, read_number<float>},
                                            {"double", "float64", 8, read_number<double>}}};

/// The values that a cloud has, in the order of `set_value`.
constexpr std::array<std::string_view, 6> kPlyValues = {"x", "y", "z", "red", "green", "blue"};

constexpr double kLeastCell_m = 0.04;  ///< of a thinned cloud
constexpr double kLeastStep = 1.1;     ///< between sides of its cells

struct PlyProperty {
  const PlyType* type = nullptr;
  std::size_t value = kPlyValues.size();  ///< index of kPlyValues; their number: skipped
};

struct PlyHeader {
  bool ascii = false;
  std::size_t points = 0;
  std::vector<PlyProperty> properties;
  std::size_t bytes = 0;  ///< of the header
};

PlyProperty parse_property(std::istringstream& words, const std::string& place) {
  std::string type, name;
  words >> type >> name;
  const auto* const found = std::ranges::find_if(
      kPlyTypes, [&](const PlyType& known) { return known.name == type || known.other_name == type; });
  if (found == kPlyTypes.end())
    throw InputError(place, "has a vertex property of the type \"" + type + "\"; expected numbers, no lists");
  const auto* const value = std::ranges::find(kPlyValues, name);
  return {.type = found, .value = static_cast<std::size_t>(value - kPlyValues.begin())};
}

PlyHeader parse_ply_header(const std::string& text, const std::string& place) {
  constexpr std::string_view kEnd = "end_header\n";
  const std::size_t end = text.find(kEnd);
  if (!text.starts_with("ply") || end == std::string::npos)
    throw InputError(place, "is no PLY file; expected \"ply\" and a header that ends with \"end_header\"");
  PlyHeader header{.bytes = end + kEnd.size()};
  std::istringstream lines(text.substr(0, end));
  std::string element;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word, argument;
    words >> word;
    if (word == "format") {
      words >> argument;
      header.ascii = argument == "ascii";
      if (!header.ascii && argument != "binary_little_endian")
        throw InputError(place, "has the format " + argument + "; expected ascii or binary_little_endian");
    } else if (word == "element") {
      if (element != "" && element != "vertex" && header.points == 0)
        throw InputError(place, "has other elements in front of the vertices; write the vertices first");
      words >> element;
      if (element == "vertex") words >> header.points;
    } else if (word == "property" && element == "vertex") {
      header.properties.push_back(parse_property(words, place));
    }
  }
  for (std::size_t value = 0; value < 3; ++value) {
    if (std::ranges::count(header.properties, value, &PlyProperty::value) != 1)
      throw InputError(place, "needs the vertex properties x, y and z, each once");
  }
  if (header.points == 0) throw InputError(place, "contains no points");
  return header;
}

void set_value(CloudPoint& point, std::size_t value, double number) {
  if (value < 3) point.p[static_cast<Eigen::Index>(value)] = static_cast<float>(number);
  if (value >= 3 && value < kPlyValues.size())
    point.rgb[value - 3] = static_cast<std::uint8_t>(std::clamp(number, 0.0, 255.0));
}

/// @param format of the points
std::string ply_header(const std::string& format, std::size_t points) {
  return kPlyMagic + ("format " + format) + " 1.0\nelement vertex " + std::to_string(points) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
         "property uchar blue\nend_header\n";
}

}  // namespace

std::string ply_bytes(const std::vector<CloudPoint>& cloud) {
  std::string bytes = ply_header("binary_little_endian", cloud.size());
  for (const CloudPoint& point : cloud) {
    bytes.append(reinterpret_cast<const char*>(point.p.data()), 3 * sizeof(float));
    bytes.append(reinterpret_cast<const char*>(point.rgb.data()), point.rgb.size());
  }
  return bytes;
}

std::string ply_text(const std::vector<CloudPoint>& cloud) {
  std::string text = ply_header("ascii", cloud.size());
  std::array<char, 192> row{};  // the longest float has 43 characters
  for (const CloudPoint& point : cloud) {
    std::snprintf(row.data(), row.size(), "%.3f %.3f %.3f %d %d %d\n", static_cast<double>(point.p.x()),
                  static_cast<double>(point.p.y()), static_cast<double>(point.p.z()), point.rgb[0],
                  point.rgb[1], point.rgb[2]);
    text += row.data();
  }
  return text;
}

std::vector<CloudPoint> parse_ply(const std::string& text, const std::string& place) {
  const PlyHeader header = parse_ply_header(text, place);
  const InputError early(place, "ends before its last point; copy the file again");
  std::size_t row_bytes = 0;
  for (const PlyProperty& property : header.properties) row_bytes += property.type->bytes;
  const std::size_t body = text.size() - header.bytes;
  if (header.points > body / (header.ascii ? 1 : row_bytes)) throw early;
  std::istringstream words(header.ascii ? text.substr(header.bytes) : std::string());
  std::vector<CloudPoint> cloud(header.points);
  const char* next = text.data() + header.bytes;
  for (CloudPoint& point : cloud) {
    for (const PlyProperty& property : header.properties) {
      double number = 0.0;
      if (header.ascii) {
        if (!(words >> number) && words.eof()) throw early;
        if (!words) throw InputError(place, "contains a text that is no finite number; remove its point");
      } else {
        number = property.type->read(next);
        next += property.type->bytes;
      }
      set_value(point, property.value, number);
    }
    if (!point.p.allFinite()) throw InputError(place, "contains a point that is not finite; remove it");
  }
  return cloud;
}

std::vector<CloudPoint> thinned_cloud(const std::vector<CloudPoint>& cloud, std::size_t max_points) {
  STILLPOINT_CHECK(max_points >= 8);
  std::vector<CloudPoint> kept = cloud;
  for (double cell_m = kLeastCell_m; kept.size() > max_points;) {
    // The number of cells that a surface passes through is proportional to 1 / cell_m^2.
    const double excess = static_cast<double>(kept.size()) / static_cast<double>(max_points);
    cell_m *= std::max(kLeastStep, std::sqrt(excess));
    std::set<std::tuple<double, double, double>> taken;
    std::erase_if(kept, [&](const CloudPoint& point) {
      const Eigen::Array3d cell = (point.p.cast<double>() / cell_m).array().floor();
      return !taken.emplace(cell.x(), cell.y(), cell.z()).second;
    });
  }
  return kept;
}

std::vector<CloudPoint> read_ply(const std::filesystem::path& file) {
  return parse_ply(read_text_file(file), file.string());
}

}  // namespace stillpoint::eval
