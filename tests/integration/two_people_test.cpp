// SPDX-License-Identifier: BSD-3-Clause
// Real people before a camera that stands still: what is flagged, and how far the estimate strays.
#include <cmath>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/integration/two_people_labels.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_data.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPeople = "two_people_d435";
constexpr const char* kDetectors = "detectors";

/// Nearer to an outline a corner may belong to either side [px].
constexpr double kOutline_px = 8.0;

struct Flagged {
  int all = 0;
  int flagged = 0;
  [[nodiscard]] double share() const { return static_cast<double>(flagged) / all; }
};
struct Tally {
  Flagged people;
  Flagged background;
};

/// Distance to the nearer person's outline [px]; positive inside.
double inside_people(const LabelledPicture& labels, double u, double v) {
  const cv::Point2f at(static_cast<float>(kLabelScale * u), static_cast<float>(kLabelScale * v));
  return std::max(cv::pointPolygonTest(labels.seated, at, true),
                  cv::pointPolygonTest(labels.standing, at, true)) /
         kLabelScale;
}

/// Columns of verdicts.csv: frame,t,id,u_px,v_px,depth_m,age,verdict,...
Tally tally(const fs::path& dump) {
  Tally result;
  std::ifstream rows(dump);
  std::string row;
  std::getline(rows, row);
  while (std::getline(rows, row)) {
    std::istringstream text(row);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
    for (const LabelledPicture& labels : two_people_labels()) {
      if (std::stoi(cells[0]) != labels.frame) continue;
      const double inside = inside_people(labels, std::stod(cells[3]), std::stod(cells[4]));
      if (std::abs(inside) < kOutline_px) continue;
      Flagged& kind = inside > 0.0 ? result.people : result.background;
      ++kind.all;
      kind.flagged += cells[7] != "stable";
    }
  }
  return result;
}

/// Root mean square of the distance from the first position [m]: the camera does not move.
double strayed_m(const fs::path& trajectory) {
  std::ifstream rows(trajectory);
  std::vector<cv::Point3d> positions;
  for (std::string row; std::getline(rows, row);) {
    std::istringstream text(row);
    double t = 0.0;
    cv::Point3d p;
    if (text >> t >> p.x >> p.y >> p.z) positions.push_back(p);
  }
  double sum = 0.0;
  for (const cv::Point3d& p : positions) sum += (p - positions.front()).dot(p - positions.front());
  return std::sqrt(sum / static_cast<double>(positions.size()));
}

std::string network(const std::string& key, const std::string& file) {
  return "detector." + key + "=" +
         (*find_test_data(kDetectors) / ("yolo-fastest-1.1_coco__" + file)).string();
}

ProgramResult run_over_people(const fs::path& out, bool detect) {
  std::vector<std::string> arguments = {
      "run", find_test_data(kPeople)->string(), "--out", out.string(), "--dump", "verdicts", "--variant",
      "vo"};
  std::vector<std::string> settings = {"detector.kind=none"};
  if (detect) {
    settings = {"detector.kind=network", network("weights", "yolo-fastest-1.1.weights"),
                network("cfg", "yolo-fastest-1.1.cfg"), network("names", "coco.names")};
  }
  for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
  return run_program(arguments);
}

TEST(TwoPeople, AreFlaggedAndTheCameraStandsStill) {
  for (const char* needed : {kPeople, kDetectors}) {
    if (!find_test_data(needed)) GTEST_SKIP() << missing_test_data(needed);
  }
  const TemporaryFolder out;
  const ProgramResult detected = run_over_people(out.path() / "with", true);
  ASSERT_EQ(detected.exit_code, 0) << detected.err;
  const Tally with = tally(out.path() / "with" / "verdicts.csv");
  RecordProperty("people_flagged", std::to_string(with.people.share()));
  RecordProperty("background_flagged", std::to_string(with.background.share()));
  EXPECT_GE(with.people.all, 30);
  EXPECT_GE(with.people.share(), 0.90) << with.people.flagged << " of " << with.people.all;
  EXPECT_LE(with.background.share(), 0.05) << with.background.flagged << " of " << with.background.all;
  const double strayed = strayed_m(out.path() / "with" / "trajectory.tum");
  EXPECT_LE(strayed, 0.01);

  ASSERT_EQ(run_over_people(out.path() / "without", false).exit_code, 0);
  const double strayed_without = strayed_m(out.path() / "without" / "trajectory.tum");
  EXPECT_LT(strayed, strayed_without);
  EXPECT_LT(tally(out.path() / "without" / "verdicts.csv").people.share(), with.people.share());
  std::cout << "flagged: people " << with.people.share() << ", background " << with.background.share()
            << "; strayed " << strayed << " m, without detection " << strayed_without << " m\n";
}

}  // namespace
}  // namespace stillpoint
