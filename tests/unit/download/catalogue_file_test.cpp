// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <set>

#include "bench/plan/sequence_registry.h"
#include "datasets/catalogue/catalogue.h"
#include "tests/support/expect_input_error.h"

namespace stillpoint::datasets {
namespace {

const std::string kHead = R"(name = "d"
title = "t"
licence = "l"
layout = "tum"
urls = ["https://host/{}", "http://mirror/{}"]
)";
const std::string kSeries = R"([[sequences]]
name = "s_{}"
group = "g"
files = ["x/{}.tgz", "common.tgz"]
folder = "data/{}"
members = ["a", "b"]
)";

TEST(CatalogueFile, ExpandsMembers) {
  const CatalogueDataset dataset = parse_catalogue(
      kHead + kSeries + "[archives.\"x/a.tgz\"]\nbytes = 7\nmd5 = \"" + std::string(32, 'a') + "\"\n", "f");
  ASSERT_EQ(dataset.sequences.size(), 2U);
  EXPECT_EQ(catalogue_name(dataset, dataset.sequences[0]), "d/s_a");
  EXPECT_EQ(registered_name(dataset, dataset.sequences[1]), "d_s_b");
  EXPECT_EQ(dataset.sequences[1].folder, "data/b");
  EXPECT_EQ(dataset.archives.size(), 3U);
  EXPECT_EQ(archive_of(dataset, "x/a.tgz").urls,
            (std::vector<std::string>{"https://host/x/a.tgz", "http://mirror/x/a.tgz"}));
  EXPECT_EQ(archive_of(dataset, "x/a.tgz").bytes, 7U);
  EXPECT_EQ(published_bytes(dataset, {"x/a.tgz"}), 7U);
  EXPECT_EQ(published_bytes(dataset, {"x/a.tgz", "common.tgz"}), 0U);
}

TEST(CatalogueFile, RejectsFaultsWithTheirLine) {
  const std::vector<std::pair<std::string, std::string>> faults{
      {"name = 1", "f:1"},
      {kHead, "[[sequences]]"},
      {kHead + kSeries + kSeries, "occurs twice"},
      {kHead + "sequences = 1", "[[sequences]]"},
      {kHead + "[[sequences]]\nmembers = [\"../x\"]", "name \"../x\""},
      {kHead + "[[sequences]]\nmembers = [\"a\"]\nfolder = \"../{}\"", "path \"../a\""},
      {kHead + "[[sequences]]\nmembers = [\"a\"]\nfiles = [\"/etc/{}\"]", "path \"/etc/a\""},
      {kHead + kSeries + "[archives.\"x/c.tgz\"]\nbytes = 1", "no sequence uses"},
      {kHead + kSeries + "[archives.\"x/a.tgz\"]\nsha256 = \"12\"", "64 lower-case"},
      {kHead + kSeries + "[archives.\"x/a.tgz\"]\nbytes = -1", "positive number"},
      {kHead + kSeries + "[archives.\"x/a.tgz\"]\nurls = [\"file:///etc/passwd\"]", "http"},
      {"typo = 1\n" + kHead + kSeries, "unknown key \"typo\""},
      {"a = [", "not valid TOML"},
      {std::string("[\0", 2), "0x00"},
      {"\xEF\xB9\xBF", "0xef"}};
  for (const auto& [text, part] : faults)
    expect_input_error([&] { static_cast<void>(parse_catalogue(text, "f")); }, {"f", part});
}

TEST(CatalogueFile, PatternsSelectSequencesGroupsAndDatasets) {
  const std::vector<CatalogueDataset> datasets{parse_catalogue(kHead + kSeries, "f")};
  EXPECT_EQ(matching_entries(datasets, "d/s_a").size(), 1U);
  EXPECT_EQ(matching_entries(datasets, "d_s_a").size(), 1U);
  EXPECT_EQ(matching_entries(datasets, "d/*").size(), 2U);
  EXPECT_EQ(matching_entries(datasets, "d/g").size(), 2U);
  EXPECT_EQ(matching_entries(datasets, "d").size(), 2U);
  EXPECT_EQ(matching_entries(datasets, "e").size(), 0U);
}

TEST(EmbeddedCatalogues, AreValidAndComplete) {
  std::set<std::string> names;
  std::size_t bonn = 0;
  for (const CatalogueDataset& dataset : bench::load_catalogues()) {
    names.insert(dataset.name);
    EXPECT_FALSE(dataset.citation.empty()) << dataset.name;
    EXPECT_FALSE(dataset.homepage.empty()) << dataset.name;
    if (dataset.name == "bonn") bonn = dataset.sequences.size();
    for (const CatalogueSequence& sequence : dataset.sequences) {
      const bool has_files = !sequence.archives.empty();
      EXPECT_TRUE(has_files || !dataset.manual.empty()) << catalogue_name(dataset, sequence);
    }
  }
  for (const char* name : {"tum", "bonn", "openloris", "euroc", "tum_vi", "vcu_rvi", "cid_sims", "eth3d",
                           "seven_scenes", "icl_nuim", "viode"})
    EXPECT_TRUE(names.contains(name)) << name;
  EXPECT_EQ(bonn, 26U);  // the number of archives of the host
}

TEST(EmbeddedCatalogues, AdviseTheCommandForASequence) {
  const std::vector<CatalogueDataset> datasets = bench::load_catalogues();
  EXPECT_EQ(bench::fetch_advice(datasets, "tum_fr3_walking_xyz"),
            "run `stillpoint data get tum/fr3_walking_xyz`");
  EXPECT_EQ(bench::fetch_advice(datasets, "unknown"), "");
}

}  // namespace
}  // namespace stillpoint::datasets
