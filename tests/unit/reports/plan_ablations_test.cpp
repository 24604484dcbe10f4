// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/plan_ablations.h"

#include <gtest/gtest.h>

#include "bench/store/store_writer.h"
#include "reports/page/report_page.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::report {
namespace {

struct VariantErrors {
  std::string variant;
  std::vector<double> by_seed;  ///< ATE [m]
  std::string system = "stillpoint";
  double coverage = 1.0;
};

/// Stores one run per variant and seed, and a plan over them.
void add_plan(const std::filesystem::path& file, const std::string& name, const std::string& text,
              const std::vector<VariantErrors>& variants) {
  bench::StoreWriter writer(file);
  bench::StoredPlan plan{.name = name, .title = "", .text = text, .run_keys = {}};
  for (const VariantErrors& variant : variants) {
    for (std::size_t i = 0; i < variant.by_seed.size(); ++i) {
      const bench::RunIdentity identity{.system = variant.system,
                                        .variant = variant.variant,
                                        .sequence = "walking",
                                        .config_hash = variant.variant,
                                        .seed = static_cast<std::int64_t>(i) + 1};
      if (writer.acquire(identity) == bench::RunLease::kGranted)
        writer.finish(identity, {.metrics = {{"ate_rmse_m", "compat:tum", "m", variant.by_seed[i]},
                                             {"coverage", "", "", variant.coverage}}});
      plan.run_keys.push_back(bench::run_key(identity));
    }
  }
  writer.record_plan(plan);
}

std::string page_of(const std::filesystem::path& file) {
  const bench::Store store(file);
  return report_html(store, report_subject(store, ""));
}

/// Text of the cell "all" of a variant in the first heat map; empty if there is none.
std::string cell_of(const std::string& page, const std::string& variant) {
  const std::size_t map = page.find("class=\"heat\"");
  if (map == std::string::npos) return "";
  const std::size_t row = page.find("<th scope=\"row\">" + variant + "</th>", map);
  if (row == std::string::npos) return "";
  const std::size_t cell = page.find("<td", row);
  return page.substr(cell, page.find("</td>", cell) - cell);
}

TEST(PlanAblations, CompareWithTheBaseOfThePlan) {
  // The overlay makes stillpoint, its base, worse, but it is still better than dynamic_vins.
  const TemporaryFolder folder;
  add_plan(folder.path() / "s", "quick", "ablation_base = \"stillpoint\"\n",
           {{"stillpoint", {0.010}}, {"dynamic_vins", {0.025}}, {"wo_circular_mask", {0.015}}});
  const std::string page = page_of(folder.path() / "s");
  EXPECT_NE(page.find("relative to stillpoint, base of plan quick"), std::string::npos);
  EXPECT_NE(cell_of(page, "wo_circular_mask").find("class=\"worse insignificant\""), std::string::npos);
  EXPECT_NE(cell_of(page, "wo_circular_mask").find("+50.0 %"), std::string::npos);  // 0.015 / 0.010 - 1
  EXPECT_EQ(cell_of(page, "stillpoint"), "");
}

TEST(PlanAblations, APlanWithoutABaseHasNoneAndThePageSaysWhy) {
  const TemporaryFolder folder;
  add_plan(folder.path() / "s", "old", "title = \"t\"\n", {{"dynamic_vins", {0.01}}, {"wo_mcc", {0.02}}});
  const std::string page = page_of(folder.path() / "s");
  EXPECT_EQ(page.find("class=\"heat\""), std::string::npos);
  EXPECT_NE(page.find("Plan old has no ablation: its stored text names no base variant"), std::string::npos);
}

TEST(PlanAblations, EveryPlanWithABaseHasItsOwn) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "s";
  add_plan(file, "p", "ablation_base = \"a\"\n", {{"a", {0.01}}, {"b", {0.02}}});
  add_plan(file, "q", "ablation_base = \"b\"\n", {{"a", {0.01}}, {"b", {0.02}}});
  add_plan(file, "r", "ablation_base = \"c\"\n", {{"a", {0.01}}, {"b", {0.02}}});
  const std::string page = page_of(file);
  EXPECT_NE(page.find("relative to a, base of plan p"), std::string::npos);
  EXPECT_NE(page.find("relative to b, base of plan q"), std::string::npos);
  EXPECT_NE(page.find("Plan r has no ablation: its base c has no run on this page."), std::string::npos);
}

TEST(PlanAblations, TheBaseIsThatOfThePlanAndNotOfAnotherSystem) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "s";
  add_plan(file, "p", "ablation_base = \"a\"\n", {{"a", {0.01}}, {"b", {0.02}}});
  add_plan(file, "q", "ablation_base = \"a\"\n", {{"a", {0.03}, "a"}, {"a+few", {0.04}, "a"}});
  EXPECT_EQ(report_subject(bench::Store(file), "").ablations.ablations.size(), 2u);
}

TEST(PlanAblations, OverlaysAreComparedWithTheVariantThatTheyExtend) {
  const TemporaryFolder folder;
  add_plan(folder.path() / "s", "p", "ablation_base = \"a\"\n",
           {{"a", {0.04}}, {"b", {0.01}}, {"b+wo_mcc", {0.02}}});
  const bench::Store store(folder.path() / "s");
  const PlanAblations ablations = report_subject(store, "p").ablations;
  ASSERT_EQ(ablations.ablations.size(), 2u);
  EXPECT_EQ(ablations.ablations[1].base, "b");
  EXPECT_FALSE(ablations.ablations[1].is_base_of_plan);
  EXPECT_NE(page_of(folder.path() / "s").find("relative to b, which these variants of plan p extend"),
            std::string::npos);
}

TEST(HeatMap, ThreePairsAreNeverDrawnAsSignificant) {
  const TemporaryFolder folder;
  add_plan(folder.path() / "s", "p", "ablation_base = \"a\"\n",
           {{"a", {0.010, 0.011, 0.012}}, {"b", {0.020, 0.022, 0.024}}});
  const std::string cell = cell_of(page_of(folder.path() / "s"), "b");
  EXPECT_NE(cell.find("class=\"worse insignificant\""), std::string::npos) << cell;
  EXPECT_NE(cell.find("n = 3, no interval"), std::string::npos) << cell;
}

TEST(HeatMap, AChangeThatEnoughPairsSupportIsNotHatched) {
  // Every pair doubles: the smallest two-sided p of 8 pairs is 2^-7 < 0.05.
  const TemporaryFolder folder;
  const std::vector<double> base = {0.010, 0.011, 0.012, 0.013, 0.014, 0.015, 0.016, 0.017};
  std::vector<double> changed;
  for (const double value : base) changed.push_back(2.0 * value);
  add_plan(folder.path() / "s", "p", "ablation_base = \"a\"\n", {{"a", base}, {"b", changed}});
  const std::string cell = cell_of(page_of(folder.path() / "s"), "b");
  EXPECT_NE(cell.find("class=\"worse\""), std::string::npos) << cell;
  EXPECT_NE(cell.find("n = 8, +100.0 to +100.0 %"), std::string::npos) << cell;
}

TEST(HeatMap, ASmallErrorOfALostTrackIsNotDrawnAsBetter) {
  const TemporaryFolder folder;
  add_plan(folder.path() / "s", "p", "ablation_base = \"a\"\n",
           {{"a", {0.010, 0.011, 0.012, 0.013, 0.014, 0.015}},
            {"b", {0.005, 0.006, 0.007, 0.008, 0.009, 0.010}, "stillpoint", 0.33}});
  const std::string cell = cell_of(page_of(folder.path() / "s"), "b");
  EXPECT_NE(cell.find("class=\"equal insignificant\""), std::string::npos) << cell;
  EXPECT_NE(cell.find("coverage 0.33, base 1.00: not comparable"), std::string::npos) << cell;
}

TEST(HeatMap, NoChangeIsNeitherBetterNorWorse) {
  const TemporaryFolder folder;
  add_plan(folder.path() / "s", "p", "ablation_base = \"a\"\n", {{"a", {0.01}}, {"b", {0.01}}});
  EXPECT_NE(cell_of(page_of(folder.path() / "s"), "b").find("class=\"equal insignificant\""),
            std::string::npos);
}

}  // namespace
}  // namespace stillpoint::report
