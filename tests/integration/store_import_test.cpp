// SPDX-License-Identifier: BSD-3-Clause
// Results of evo as runs of a store.
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "tests/support/program.h"
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

/// A result of evo_ape with two errors. @param label e.g. "APE (m)"
std::filesystem::path write_result(const TemporaryFolder& folder, const std::string& label, double rmse) {
  const std::filesystem::path file = folder.path() / "result.zip";
  write_archive(
      file, {{.path = "info.json",
              .content = "{\"title\": \"APE w.r.t. translation part (m)\\n(with SE(3) Umeyama alignment)\", "
                         "\"label\": \"" +
                         label + "\", \"ref_name\": \"data/fr3_xyz.txt\", \"est_name\": \"runs/orb.txt\"}"},
             {.path = "stats.json", .content = "{\"rmse\": " + std::to_string(rmse) + "}"},
             {.path = "error_array.npy", .content = numpy_file({0.3, 0.4})}});
  return file;
}

TEST(StoreImport, AResultOfEvoIsARun) {
  const TemporaryFolder folder;
  const std::string store = (folder.path() / "s.sqlite").string();
  const std::string file = write_result(folder, "APE (m)", 0.353553).string();  // sqrt((0.09 + 0.16) / 2)
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

TEST(StoreImport, AContradictingOrUnknownResultOfEvoIsAnError) {
  const TemporaryFolder folder;
  const std::string store = (folder.path() / "s.sqlite").string();
  const auto error_of = [&](const std::string& file) {
    const ProgramResult result = run_program({"store", "import", file, "--store", store});
    EXPECT_EQ(result.exit_code, 2);
    return result.err;
  };
  EXPECT_NE(error_of(write_result(folder, "APE (m)", 0.2).string()).find("have 0.353553"), std::string::npos);
  EXPECT_NE(
      error_of(write_result(folder, "APE (unit-less)", 0.353553).string()).find("trans_part or angle_deg"),
      std::string::npos);
  write_archive(folder.path() / "other.zip", {{.path = "readme.txt", .content = "no"}});
  EXPECT_NE(error_of((folder.path() / "other.zip").string()).find("has no info.json"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(store));
}

}  // namespace
}  // namespace stillpoint
