// SPDX-License-Identifier: BSD-3-Clause
// Results of other tools as runs of a store. All their files are made up from the documentation.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "eval/io/text_reader.h"
#include "tests/support/program.h"
#include "tests/support/rejection.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_archive.h"

namespace stillpoint {
namespace {

/// A vector as numpy.save writes it.
std::string numpy_file(const std::vector<double>& numbers) {
  const std::string header =
      "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(numbers.size()) + ",), }\n";
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size());
  bytes += '\0';
  bytes += header;
  const std::size_t begin = bytes.size();
  bytes.resize(begin + numbers.size() * sizeof(double));
  std::memcpy(bytes.data() + begin, numbers.data(), numbers.size() * sizeof(double));
  return bytes;
}

/// What evo writes into info.json.
struct EvoInfo {
  std::string label = "APE (m)";
  std::string title = "APE w.r.t. translation part (m)\\n(with SE(3) Umeyama alignment)";
  std::string reference = "data/fr3_xyz.txt";
  std::string estimate = "runs/orb.txt";
};

constexpr double kRmse = 0.353553;  // of the errors 0.3 and 0.4: sqrt((0.09 + 0.16) / 2)

std::string write_result(const TemporaryFolder& folder, const EvoInfo& info, double rmse = kRmse) {
  const std::filesystem::path file = folder.path() / "result.zip";
  write_archive(file, {{.path = "info.json",
                        .content = R"({"title": ")" + info.title + R"(", "label": ")" + info.label +
                                   R"(", "ref_name": ")" + info.reference + R"(", "est_name": ")" +
                                   info.estimate + "\"}"},
                       {.path = "stats.json", .content = "{\"rmse\": " + std::to_string(rmse) + "}"},
                       {.path = "error_array.npy", .content = numpy_file({0.3, 0.4})}});
  return file.string();
}

TEST(StoreImport, AResultOfEvoIsARun) {
  const TemporaryFolder folder;
  const std::string store = (folder.path() / "s.sqlite").string();
  const std::string file = write_result(folder, {});
  const ProgramResult result = run_program({"store", "import", file, "--store", store});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "1 run added, 0 already present\n");
  EXPECT_EQ(run_program({"store", "import", file, "--store", store}).out,
            "0 runs added, 1 already present\n");
  const ProgramResult stats = run_program({"stats", store, "--format", "csv"});
  EXPECT_EQ(stats.exit_code, 0) << stats.err;
  for (const char* part : {"fr3_xyz", "orb", "0.353553"})
    EXPECT_NE(stats.out.find(part), std::string::npos) << stats.out;
}

TEST(StoreImport, DifferentResultsOfEvoAreNotPooled) {
  const TemporaryFolder folder;
  const std::string store = (folder.path() / "s.sqlite").string();
  const auto import = [&](const EvoInfo& info, std::vector<std::string> options = {}) {
    std::vector<std::string> arguments = {"store", "import", write_result(folder, info), "--store", store};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_program(arguments);
  };
  const EvoInfo aligned{.reference = "tum/fr3_xyz/groundtruth.txt", .estimate = "orb/fr3_xyz/trajectory.txt"};
  EvoInfo unaligned = aligned;
  unaligned.title = "APE w.r.t. translation part (m)\\n(not aligned)";
  EvoInfo other = aligned;
  other.reference = "/data/euroc/V1_01/mav0/state_groundtruth_estimate0/data.csv";
  other.estimate = "orb/V1_01/trajectory.txt";
  EvoInfo relative = aligned;
  relative.label = "RPE (m)";
  relative.title = "RPE w.r.t. translation part (m)\\nfor delta = 1 (frames) using consecutive pairs";
  for (const EvoInfo& info : {aligned, other, relative}) {
    const ProgramResult result = import(info);
    EXPECT_EQ(result.out, "1 run added, 0 already present\n") << result.err;
  }
  expect_rejected(import(unaligned), {"another ate_rmse_m of orb on fr3_xyz", "(not aligned)", "--system"});
  EXPECT_EQ(import(unaligned, {"--system", "orb_raw"}).exit_code, 0);
  EvoInfo unnamed = aligned;
  unnamed.reference = "groundtruth.txt";
  expect_rejected(import(unnamed), {"names no sequence", "--sequence NAME"});

  const std::string tidy = (folder.path() / "tidy.csv").string();
  ASSERT_EQ(run_program({"store", "export", tidy, "--tidy", "--store", store}).exit_code, 0);
  for (const char* part : {",orb,orb,fr3_xyz,", ",orb,orb,V1_01,", ",orb_raw,orb_raw,fr3_xyz,"})
    EXPECT_NE(eval::read_text_file(tidy).find(part), std::string::npos) << eval::read_text_file(tidy);
  const ProgramResult stats = run_program({"stats", store});
  EXPECT_EQ(stats.out.find("on the same data"), std::string::npos) << stats.out;
  std::filesystem::copy(store, folder.path() / "head.sqlite");
  const ProgramResult compared = run_program({"compare", store, (folder.path() / "head.sqlite").string()});
  EXPECT_NE(compared.out.find("4 pairs"), std::string::npos) << compared.out << compared.err;
}

TEST(StoreImport, AContradictingOrUnknownResultOfEvoIsAnError) {
  const TemporaryFolder folder;
  const std::string store = (folder.path() / "s.sqlite").string();
  const auto error_of = [&](const std::string& file) {
    const ProgramResult result = run_program({"store", "import", file, "--store", store});
    EXPECT_EQ(result.exit_code, 2);
    return result.err;
  };
  EXPECT_NE(error_of(write_result(folder, {}, 0.2)).find("have 0.353553"), std::string::npos);
  for (const EvoInfo& info :
       {EvoInfo{.label = "APE (unit-less)"}, EvoInfo{.title = "APE w.r.t. point distance (m)"}})
    EXPECT_NE(error_of(write_result(folder, info)).find("trans_part or angle_deg"), std::string::npos);
  write_archive(folder.path() / "other.zip", {{.path = "readme.txt", .content = "no"}});
  EXPECT_NE(error_of((folder.path() / "other.zip").string()).find("has no info.json"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(store));

  const std::string damaged = folder.write("damaged.zip", "PK\x03\x04 no zip").string();
  std::filesystem::create_directory(folder.path() / "tmp");
  expect_rejected(run_program({"store", "import", damaged, "--store", store},
                              {.environment = {"TMPDIR=" + (folder.path() / "tmp").string()}}),
                  {"damaged.zip"});
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "tmp"));
  expect_rejected(run_program({"store", "import", damaged, "--store", store},
                              {.environment = {"TMPDIR=" + (folder.path() / "none").string()}}),
                  {"TMPDIR=", "no folder for temporary files"});
}

/// How the rows of a made-up trajectory are written.
struct RowStyle {
  std::string header;
  bool nanoseconds = false;
  std::string_view separator = " ";
};

/// A spiral over 3 s.
/// @param scale of the positions
/// @param wobble_m added to every second position, upwards
std::string spiral(const RowStyle& style, double scale = 1.0, double wobble_m = 0.0) {
  std::string text = style.header;
  for (int i = 0; i < 31; ++i) {
    const double t = 0.1 * i, z = 0.1 * t + (i % 2) * wobble_m;
    const std::string stamp = style.nanoseconds
                                  ? fmt::format("{}", 1'700'000'000'000'000'000 + i * 100'000'000LL)
                                  : fmt::format("{:.6f}", 1.7e9 + t);
    text += fmt::format("{1}{0}{2:.6f}{0}{3:.6f}{0}{4:.6f}{0}0{0}0{0}0{0}1\n", style.separator, stamp,
                        scale * std::cos(t), scale * std::sin(t), scale * z);
  }
  return text;
}

const RowStyle kOvEval{.header = "# timestamp(s) tx ty tz qx qy qz qw\n"};
const RowStyle kEvalio{.header =
                           "# name: kiss\n# pipeline: kiss\n# voxel_size: 0.5\n#\n"
                           "# timestamp, x, y, z, qx, qy, qz, qw\n",
                       .separator = ", "};
const RowStyle kVslamLab{
    .header = "ts (ns),tx (m),ty (m),tz (m),qx,qy,qz,qw\n", .nanoseconds = true, .separator = ","};

/// Result folders, a store, and the import into it.
class ResultImport {
 public:
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  void write(const std::string& name, const std::string& text) const {
    const std::filesystem::path file = folder_.path() / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }
  [[nodiscard]] ProgramResult import(const std::string& name,
                                     const std::vector<std::string>& options = {}) const {
    std::vector<std::string> arguments = {"store", "import", path(name), "--store", path("s.sqlite")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_program(arguments);
  }
  [[nodiscard]] std::string tidy() const {
    EXPECT_EQ(
        run_program({"store", "export", path("t.csv"), "--tidy", "--force", "--store", path("s.sqlite")})
            .exit_code,
        0);
    return eval::read_text_file(path("t.csv"));
  }
  /// Value of the ATE of the run whose row contains the words; NaN without one.
  [[nodiscard]] double ate_m(const std::string& words) const {
    std::istringstream rows(tidy());
    for (std::string row; std::getline(rows, row);) {
      const std::size_t metric = row.find("ate_rmse_m");
      if (metric == std::string::npos || row.find(words) == std::string::npos) continue;
      std::istringstream fields(row.substr(metric));
      std::string field;
      while (std::getline(fields, field, ',')) {
        char* end = nullptr;
        const double value = std::strtod(field.c_str(), &end);
        if (!field.empty() && *end == '\0') return value;
      }
    }
    return std::nan("");
  }

 private:
  TemporaryFolder folder_;
};

TEST(StoreImport, AFolderOfOvEvalIsScored) {
  const ResultImport results;
  results.write("ov/truth/room.txt", spiral(kOvEval));
  results.write("ov/algorithms/vins/room/run1.txt", spiral(kOvEval, 1.0, 0.02));
  results.write("ov/algorithms/vins/room/run2.txt", spiral(kOvEval));
  results.write("ov/algorithms/okvis/room/run1.txt", "# timestamp(s) tx ty tz qx qy qz qw\n");
  const ProgramResult first = results.import("ov");
  EXPECT_EQ(first.out, "3 runs added, 0 already present\n") << first.err;
  EXPECT_EQ(results.import("ov").out, "0 runs added, 3 already present\n");
  EXPECT_NEAR(results.ate_m(",vins,vins,room,"), 0.01, 1e-3) << results.tidy();
  const ProgramResult list = run_program({"store", "list", results.path("s.sqlite")});
  EXPECT_NE(list.out.find("wrote a trajectory without poses"), std::string::npos) << list.out;

  results.write("ov/algorithms/vins/room/run1.txt", spiral(kOvEval, 1.0, 0.04));
  expect_rejected(results.import("ov"), {"another ate_rmse_m of vins on room", "another --store"});
  expect_rejected(results.import("ov", {"--system", "x"}), {"--system", "no effect"});
}

TEST(StoreImport, AFolderOfEvalioIsScored) {
  const ResultImport results;
  results.write("results/hall/day_1/gt.csv", spiral(kEvalio));
  results.write("results/hall/day_1/kiss.csv", spiral(kEvalio, 1.0, 0.02));
  results.write("results/hall/day_1/kiss__voxel_size-0.1.csv", spiral(kEvalio, 1.0, 0.06));
  const ProgramResult first = results.import("results");
  EXPECT_EQ(first.out, "2 runs added, 0 already present\n") << first.err;
  EXPECT_NEAR(results.ate_m(",kiss,kiss,hall/day_1,"), 0.01, 1e-3) << results.tidy();
  EXPECT_NEAR(results.ate_m(",kiss,kiss__voxel_size-0.1,hall/day_1,"), 0.03, 1e-3) << results.tidy();
}

TEST(StoreImport, AnExperimentOfVslamLabHasItsFailedRunsAndNoScale) {
  const ResultImport results;
  results.write("exp.yaml",
                "walk:\n  Config: config.yaml\n  NumRuns: 2\n  Parameters: {verbose: 1, mode: mono}\n"
                "  Module: orbslam2\n");
  results.write("config.yaml", "rgbdtum:\n  - 'desk'\n");
  results.write("evaluation/walk/RGBDTUM/desk/00000_KeyFrameTrajectory.csv", spiral(kVslamLab, 0.4, 0.02));
  results.write("evaluation/walk/RGBDTUM/desk/00000_KeyFrameTrajectory_beforeGBA.csv", "broken");
  results.write("evaluation/walk/vslamlab_exp_log.csv", "");
  results.write("benchmark/RGBDTUM/desk/groundtruth.csv", spiral(kVslamLab));
  const std::vector<std::string> options = {"--results", results.path("evaluation"), "--truth",
                                            results.path("benchmark")};
  const ProgramResult first = results.import("exp.yaml", options);
  EXPECT_EQ(first.out, "2 runs added, 0 already present\n") << first.err;
  EXPECT_NEAR(results.ate_m(",orbslam2,walk,RGBDTUM/desk,"), 0.01, 1e-3) << results.tidy();
  const ProgramResult list = run_program({"store", "list", results.path("s.sqlite")});
  EXPECT_NE(list.out.find("wrote no trajectory"), std::string::npos) << list.out;

  const ProgramResult folder =
      results.import("evaluation/walk", {"--truth", results.path("benchmark"), "--system", "orb"});
  EXPECT_EQ(folder.out, "1 run added, 0 already present\n") << folder.err;
  EXPECT_GT(results.ate_m(",orb,walk,RGBDTUM/desk,"), 0.3) << "nothing states that it has no scale";
  for (const char* part : {"00000_Key", "0.4 times as large", "scored as it is", "--fit-scale"})
    EXPECT_NE(folder.err.find(part), std::string::npos) << folder.err;
  const ProgramResult fitted = results.import(
      "evaluation/walk", {"--truth", results.path("benchmark"), "--system", "mono", "--fit-scale"});
  EXPECT_EQ(fitted.err.find("times as large"), std::string::npos) << fitted.err;
  EXPECT_NEAR(results.ate_m(",mono,walk,RGBDTUM/desk,"), 0.01, 1e-3) << results.tidy();
  EXPECT_NE(results.tidy().find("scale fitted to the ground truth"), std::string::npos);
  EXPECT_EQ(results.import("evaluation/walk/.", {"--truth", results.path("benchmark")}).exit_code, 0);
  EXPECT_GT(results.ate_m(",walk,walk,RGBDTUM/desk,"), 0.3) << "named by its folder";
  expect_rejected(results.import("exp.yaml"), {"--results"});
  expect_rejected(results.import("evaluation/walk"), {"--truth"});
  expect_rejected(results.import("exp.yaml", {"--results", results.path("benchmark"), "--truth",
                                              results.path("benchmark")}),
                  {"benchmark/walk", "does not exist", "correct --results"});
  results.write("exp.yaml", "walk:\n  Config: config.yaml\n  NumRuns: 2\n");
  expect_rejected(results.import("exp.yaml", options), {"exp.yaml", "walk.Module", "missing"});
  results.write("exp.yaml", "just a text");
  expect_rejected(results.import("exp.yaml", options), {"exp.yaml"});
}

TEST(StoreImport, RunsAreNumberedAsTheirFiles) {
  const ResultImport results;
  results.write("ov/truth/room.txt", spiral(kOvEval));
  results.write("ov/algorithms/vins/room/run2.txt", spiral(kOvEval, 1.0, 0.02));
  results.write("ov/algorithms/vins/room/run10.txt", spiral(kOvEval, 1.0, 0.1));
  EXPECT_EQ(results.import("ov").out, "2 runs added, 0 already present\n");
  results.write("ov/algorithms/vins/room/run1.txt", spiral(kOvEval));
  const ProgramResult later = results.import("ov");
  EXPECT_EQ(later.out, "1 run added, 2 already present\n") << later.err;
  EXPECT_NE(run_program({"store", "list", results.path("s.sqlite")}).out.find("repetition 10"),
            std::string::npos);

  results.write("lab/vslamlab_exp_log.csv", "");
  results.write("truth/D/desk/groundtruth.csv", spiral(kVslamLab));
  results.write("lab/D/desk/00004_KeyFrameTrajectory.csv", spiral(kVslamLab));
  EXPECT_EQ(results.import("lab", {"--truth", results.path("truth")}).exit_code, 0);
  EXPECT_NE(run_program({"store", "list", results.path("s.sqlite")}).out.find("repetition 5"),
            std::string::npos);
  results.write("lab/D/desk/best_KeyFrameTrajectory.csv", spiral(kVslamLab));
  expect_rejected(results.import("lab", {"--truth", results.path("truth")}),
                  {"best_Key", "NUMBER", "rename"});
}

TEST(StoreImport, SequencesWithOneNameOrOneTruthAreNotConfused) {
  const ResultImport results;
  results.write("lab/vslamlab_exp_log.csv", "");
  double wobble_m = 0.0;
  for (const char* sequence : {"A/desk", "B/desk", "B/desk_dark"}) {
    wobble_m += 0.02;
    results.write(fmt::format("truth/{}/groundtruth.csv", sequence), spiral(kVslamLab));
    results.write(fmt::format("lab/{}/00000_KeyFrameTrajectory.csv", sequence),
                  spiral(kVslamLab, 1.0, wobble_m));
  }
  const std::vector<std::string> options = {"--truth", results.path("truth"), "--system", "orb"};
  EXPECT_EQ(results.import("lab", options).out, "3 runs added, 0 already present\n");
  const ProgramResult again = results.import("lab", options);
  EXPECT_EQ(again.out, "0 runs added, 3 already present\n") << again.err;
  EXPECT_NEAR(results.ate_m(",orb,lab,B/desk,"), 0.02, 1e-3) << results.tidy();
  EXPECT_NEAR(results.ate_m(",orb,lab,B/desk_dark,"), 0.03, 1e-3) << results.tidy();

  results.write("exp.yaml", "lab:\n  Config: c.yaml\n  NumRuns: 1\n  Module: orb\n");
  results.write("c.yaml", "A:\n  - desk\n  - desk\n");
  expect_rejected(
      results.import("exp.yaml", {"--results", results.path(""), "--truth", results.path("truth")}),
      {"run 1 of lab on A/desk", "is there twice"});
}

TEST(StoreImport, ABrokenResultFolderAddsNothing) {
  const ResultImport results;
  std::filesystem::create_directories(results.path("empty"));
  expect_rejected(results.import("empty"), {"no trajectories in the layout of ov_eval"});
  results.write("ov/algorithms/vins/room/run1.txt", spiral(kOvEval));
  expect_rejected(results.import("ov"), {"room.txt", "does not exist", "--truth"});
  results.write("ov/truth/room.txt", spiral(kOvEval));
  results.write("ov/algorithms/vins/room/run2.txt", "1.7 0 0 zero 0 0 0 1\n");
  expect_rejected(results.import("ov"), {"run2.txt:1"});
  results.write("ov/algorithms/vins/room/run2.txt", "3.5 0 0 0 0 0 0 1\n3.6 0 0 0 0 0 0 1\n");
  expect_rejected(results.import("ov"), {"run2.txt", "no pose at the time"});
  for (const char* text : {"Segmentation fault, core dumped\n", "nan nan nan nan nan nan nan nan\n"}) {
    results.write("ov/algorithms/vins/room/run2.txt", text);
    expect_rejected(results.import("ov"), {"run2.txt"});
  }
  EXPECT_FALSE(std::filesystem::exists(results.path("s.sqlite")));
}

}  // namespace
}  // namespace stillpoint
