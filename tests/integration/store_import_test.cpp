// SPDX-License-Identifier: BSD-3-Clause
// Results of evo as runs of a store.
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

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
  EXPECT_EQ(result.out, "1 runs added, 0 already present\n");
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
    EXPECT_EQ(result.out, "1 runs added, 0 already present\n") << result.err;
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
}

}  // namespace
}  // namespace stillpoint
