// SPDX-License-Identifier: BSD-3-Clause
/// Every figure in every format is that of `golden_figures.txt`: rows `KIND ESTIMATES FORMAT XXH64`
/// (path_map: the path over a map), made with the fonts and the cairo of Debian 12 on amd64. A figure that
/// changes is written to the folder of temporary files, to be looked at; if it is as it should be, its row is
/// replaced by the one that the failure prints.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/content_hash.h"
#include "reports/drawing/drawing.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/reports/circle_runs.h"

namespace stillpoint::report {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

bool is_place_of_golden_figures() {
#if defined(__x86_64__)
  return bytes_of("/etc/os-release").find("VERSION_ID=\"12\"") != std::string::npos &&
         fs::exists("/etc/debian_version");
#else
  return false;
#endif
}

/// Red to the right, green upwards.
PathOptions path_over_a_map() {
  PathOptions options;
  options.map_credit = "a map of two colors";
  options.map = [](const datasets::MapWindow& window) {
    std::vector<std::uint8_t> image;
    for (int row = 0; row < window.rows; ++row) {
      for (int column = 0; column < window.columns; ++column) {
        image.push_back(static_cast<std::uint8_t>(255 * column / window.columns));
        image.push_back(static_cast<std::uint8_t>(255 - 255 * row / window.rows));
        image.push_back(0);
      }
    }
    return image;
  };
  return options;
}

TEST(GoldenFigures, AreThoseOfEveryKindAndFormat) {
  if (!is_place_of_golden_figures())
    GTEST_SKIP() << "figures depend on fonts and cairo: those of Debian 12 on amd64";
  std::set<std::string> golden;
  std::ifstream rows(STILLPOINT_SOURCE_DIR "/tests/unit/reports/golden_figures.txt");
  for (std::string row; std::getline(rows, row);) golden.insert(row);
  const TemporaryFolder folder;
  const CircleRuns circles{.near = estimate(0.1, 0.02), .far = estimate(0.4, 0.05)};
  std::size_t count = 0;
  std::vector<std::pair<FigureKind, std::string>> kinds;
  for (const auto& [kind, name] : enum_names(FigureKind{})) kinds.emplace_back(kind, name);
  kinds.emplace_back(FigureKind::kPath, "path_map");
  for (const auto& [kind, name] : kinds) {
    for (FigureInput input : {circles.one(), circles.both()}) {
      if (name == "path_map") input.path = path_over_a_map();
      const std::array<Drawing, 1> drawings{figure(kind, input, {})};
      for (const char* format : {"svg", "html", "pdf", "png"}) {
        const fs::path file = folder.path() / fmt::format("{}_{}.{}", name, input.runs.size(), format);
        write_drawings(file, drawings, 1.0, {});
        const std::string row = fmt::format("{} {} {} {}", name, input.runs.size(), format,
                                            hash_text(content_hash(bytes_of(file))));
        ++count;
        if (golden.contains(row)) continue;
        const fs::path changed = fs::path(testing::TempDir()) / file.filename();
        fs::copy_file(file, changed, fs::copy_options::overwrite_existing);
        ADD_FAILURE() << "changed, see " << changed << "\n" << row;
      }
    }
  }
  EXPECT_EQ(golden.size(), count) << "rows of figures that do not exist";
}

}  // namespace
}  // namespace stillpoint::report
