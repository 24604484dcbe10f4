// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint reproduce --real --get`, from an empty folder of downloads to the table. The rendered sequence
// replaces every recording.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/support/sequences/dataset_host.h"
#include "tests/support/sequences/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream input(file);
  return {std::istreambuf_iterator<char>(input), {}};
}

/// Offers the rendered sequence under the archive names of two recordings of TUM RGB-D; the host has lost the
/// others.
void offer_walking(const DatasetHost& host) {
  for (const std::string name : {"walking_xyz", "walking_static"}) {
    const std::string folder = "rgbd_dataset_freiburg3_" + name;
    host.offer("tum/freiburg3/" + folder + ".tgz", folder_entries(rendered_sequence(), folder + "/"));
  }
  host.add_dataset("tum",
                   "[[sequences]]\nname = \"fr3_{}\"\nfiles = [\"freiburg3/rgbd_dataset_freiburg3_{}.tgz\"]\n"
                   "folder = \"rgbd_dataset_freiburg3_{}\"\n"
                   "members = [\"walking_xyz\", \"walking_static\", \"walking_rpy\", \"walking_halfsphere\", "
                   "\"sitting_xyz\", \"sitting_static\", \"sitting_rpy\", \"sitting_halfsphere\"]\n");
}

TEST(ReproduceReal, GoesFromNothingToTheTableWithThePublishedColumn) {
  const DatasetHost host;
  offer_walking(host);
  const fs::path out = host.path() / "out";
  const std::vector<std::string> command{"reproduce",
                                         "table1",
                                         "--real",
                                         "--get",
                                         "--accept-licence",
                                         "--store",
                                         (host.path() / "store.sqlite").string(),
                                         "--out",
                                         out.string()};
  const ProgramResult result = host.run(command);
  ASSERT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_EQ(host.registered(), 2U);
  const std::string table = text_of(out / "table1.md");
  EXPECT_NE(table.find("walking\\_xyz"), std::string::npos);
  EXPECT_NE(table.find("walking\\_rpy"), std::string::npos) << "rows without data remain visible";
  EXPECT_NE(table.find("mean of 2 of 4 sequences"), std::string::npos) << table;
  EXPECT_NE(table.find("0.0486"), std::string::npos) << "the published number of Dynamic-VINS";
  EXPECT_NE(result.out.find("8 sequences, 0 available"), std::string::npos) << result.out;
}

}  // namespace
}  // namespace stillpoint
