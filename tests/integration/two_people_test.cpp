// SPDX-License-Identifier: BSD-3-Clause
// Real people in front of a static camera: dynamic labels and drift of the estimate.
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

/// Features closer to an outline than this are ignored, as they may belong to either side [px].
constexpr double kOutlineMargin_px = 8.0;

struct DynamicCount {
  int all = 0;
  int dynamic = 0;  ///< labelled as not stable
  [[nodiscard]] double ratio() const { return static_cast<double>(dynamic) / all; }
};
struct LabelCounts {
  DynamicCount people;
  DynamicCount background;
};

/// Signed distance to the outline of the nearer person [px]; positive inside.
double inside_people(const LabelledFrame& labels, double u, double v) {
  const cv::Point2f at(static_cast<float>(kLabelScale * u), static_cast<float>(kLabelScale * v));
  return std::max(cv::pointPolygonTest(labels.seated, at, true),
                  cv::pointPolygonTest(labels.standing, at, true)) /
         kLabelScale;
}

/// Columns of labels.csv: frame,t,id,u_px,v_px,depth_m,age,label,...
LabelCounts count_labels(const fs::path& dump) {
  LabelCounts result;
  std::ifstream rows(dump);
  std::string row;
  std::getline(rows, row);
  while (std::getline(rows, row)) {
    std::istringstream text(row);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
    for (const LabelledFrame& labels : kTwoPeopleLabels) {
      if (std::stoi(cells[0]) != labels.frame) continue;
      const double inside = inside_people(labels, std::stod(cells[3]), std::stod(cells[4]));
      if (std::abs(inside) < kOutlineMargin_px) continue;
      DynamicCount& count = inside > 0.0 ? result.people : result.background;
      ++count.all;
      count.dynamic += cells[7] != "stable";
    }
  }
  return result;
}

/// RMS distance from the first position [m]; the true camera is static.
double rms_drift_m(const fs::path& trajectory) {
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
      "run", find_test_data(kPeople)->string(), "--out", out.string(), "--dump", "labels", "--variant", "vo"};
  std::vector<std::string> settings = {"detector.kind=none"};
  if (detect) {
    settings = {"detector.kind=network", network("weights", "yolo-fastest-1.1.weights"),
                network("cfg", "yolo-fastest-1.1.cfg"), network("names", "coco.names")};
  }
  for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
  return run_program(arguments);
}

TEST(TwoPeople, AreLabelledDynamicAndTheEstimateDoesNotDrift) {
  for (const char* needed : {kPeople, kDetectors}) {
    if (!find_test_data(needed)) GTEST_SKIP() << missing_test_data(needed);
  }
  const TemporaryFolder out;
  const ProgramResult detected = run_over_people(out.path() / "with", true);
  ASSERT_EQ(detected.exit_code, 0) << detected.err;
  const LabelCounts with = count_labels(out.path() / "with" / "labels.csv");
  RecordProperty("people_dynamic_ratio", std::to_string(with.people.ratio()));
  RecordProperty("background_dynamic_ratio", std::to_string(with.background.ratio()));
  EXPECT_GE(with.people.all, 30);
  EXPECT_GE(with.people.ratio(), 0.90) << with.people.dynamic << " of " << with.people.all;
  EXPECT_LE(with.background.ratio(), 0.05) << with.background.dynamic << " of " << with.background.all;
  const double drift = rms_drift_m(out.path() / "with" / "trajectory.tum");
  EXPECT_LE(drift, 0.01);

  ASSERT_EQ(run_over_people(out.path() / "without", false).exit_code, 0);
  const double drift_without = rms_drift_m(out.path() / "without" / "trajectory.tum");
  EXPECT_LT(drift, drift_without);
  EXPECT_LT(count_labels(out.path() / "without" / "labels.csv").people.ratio(), with.people.ratio());
  std::cout << "dynamic ratio: people " << with.people.ratio() << ", background " << with.background.ratio()
            << "; drift " << drift << " m, without detection " << drift_without << " m\n";
}

}  // namespace
}  // namespace stillpoint
