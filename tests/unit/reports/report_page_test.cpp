// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/report_page.h"
#include "bench/model/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/config/toml_source.h"
#include "bench/model/run_csv.h"
#include "bench/store/store_writer.h"
#include "eval/io/ply_file.h"
#include "reports/page/chart_data.h"
#include "reports/page/page_data.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::report {
namespace {

TEST(PackedSeries, KeepsTheRangeAndMarksMissingValues) {
  const std::vector<double> values = {-1.0, std::numeric_limits<double>::quiet_NaN(), 65533.0};
  const nlohmann::ordered_json packed = packed_series(values);
  EXPECT_EQ(packed["low"], -1.0);
  EXPECT_EQ(packed["step"], 1.0);  // (65533 + 1) / 65534
  // 0, missing and 65534 as little-endian 16-bit numbers: 00 00 ff ff fe ff.
  EXPECT_EQ(packed["data"], "AAD///7/");
}

/// A store with one run of three frames over 1 m along x; the second frame has no pose.
void fill_store(const std::filesystem::path& file, const bench::RunIdentity& identity,
                const std::string& detail = "") {
  bench::StoreWriter writer(file);
  static_cast<void>(writer.acquire(identity));
  bench::RunOutcome outcome;
  outcome.outcome = detail.empty() ? bench::Outcome::kOk : bench::Outcome::kCrashed;
  outcome.detail = detail;
  outcome.metrics = {{"ate_rmse_m", "compat:tum", "m", 0.25}};
  outcome.attachments["trajectory"] = "1.0 0 0 0 0 0 0 1\n1.2 1 0 0 0 0 0 1\n";
  outcome.attachments["truth"] = "1.0 0 0 0 0 0 0 1\n1.1 0.5 0 0 0 0 0 1\n1.2 1 0 0 0 0 0 1\n";
  outcome.attachments["landmarks"] = "x,y,z,dynamic\n0.5,1,2,1\n0,1,2,0\n";
  outcome.attachments["surfaces"] = eval::ply_bytes({{{0.5F, 1.0F, 2.0F}, {255, 128, 8}}, {{0, 1, 2}, {}}});
  outcome.attachments["counters"] =
      "frame,t_ns,status,tracked_features,window_landmarks,depth_landmarks,dynamic_features,solver_"
      "iterations,"
      "keyframe,reset\n0,1000000000,tracking,100,50,40,25,3,1,0\n1,1100000000,lost,0,0,0,0,0,0,0\n"
      "2,1200000000,tracking,80,50,40,0,3,0,0\n";
  outcome.attachments["loops"] =
      "query_frame,query_t_ns,match_frame,match_t_ns,votes,matches,inliers,residual_px,tx,ty,tz,qx,qy,qz,qw,"
      "accepted,reason,in_map\n"
      "2,1200000000,0,1000000000,30,90,60,1.5,0,0,0,0,0,0,1,1,,0\n"
      "2,1200000000,0,1100000000,30,90,10,2,0,0,0,0,0,0,1,0,few_inliers,0\n"
      "2,1200000000,7,9000000000,30,90,60,1.5,0,0,0,0,0,0,1,1,,1\n";
  outcome.attachments["claims"] =
      "frame,t_ns,status,segment,x,y,z,qx,qy,qz,qw,sigma_m,sigma_rad\n"
      "0,1000000000,tracking,0,0,0,0,0,0,0,1,0,0\n1,1100000000,lost,0,0,0,0,0,0,0,1,0.5,0.1\n"
      "2,1200000000,tracking,0,1,0,0,0,0,0,1,0.01,0.002\n";
  outcome.attachments["timings"] =
      "frame,module,ns,calls\n0,feature_tracking,2000000,1\n2,feature_tracking,3000000,1\n";
  outcome.manifest =
      "{\"host\": {\"cpu\": \"</script><b>\"}, \"faults\": "
      "[\"blank:start=0.05,duration=0.05,every=0.1\"]}";
  writer.finish(identity, outcome);
  writer.record_plan({.name = "p",
                      .title = "Plan <p>",
                      .text = "title = \"<&>\"\n",
                      .run_keys = {bench::run_key(identity)}});
}

const std::vector<double>& column(const RunSeries& series, const std::string& name) {
  for (const SeriesColumn& candidate : series.columns) {
    if (candidate.name == name) return candidate.values;
  }
  throw std::out_of_range(name);
}

TEST(RunSeries, LinksPosesErrorsCountersAndTimesByFrame) {
  const TemporaryFolder folder;
  fill_store(folder.path() / "s", {.variant = "vo", .sequence = "a"});
  const bench::Store store(folder.path() / "s");
  const RunSeries series = run_series(store, store.runs().front());
  ASSERT_EQ(series.t_s.size(), 3u);
  EXPECT_NEAR(series.t_s[2], 0.2, 1e-12);
  EXPECT_TRUE(std::isnan(column(series, "x")[1]));
  EXPECT_NEAR(column(series, "error_m")[2], 0.0, 1e-6);  // estimate equals ground truth
  EXPECT_EQ(column(series, "dynamic")[0], 0.25);         // 25 of 100 features
  EXPECT_TRUE(std::isnan(column(series, "dynamic")[1]));
  EXPECT_EQ(column(series, "ms:feature_tracking")[2], 3.0);
  EXPECT_EQ(column(series, "status"), (std::vector<double>{1.0, 4.0, 1.0}));  // tracking, lost
}

TEST(RunSeries, ContainsThreeClaimedStandardDeviationsWhereTheyAreReported) {
  const TemporaryFolder folder;
  fill_store(folder.path() / "s", {.variant = "vo", .sequence = "a"});
  const bench::Store store(folder.path() / "s");
  const RunSeries series = run_series(store, store.runs().front());
  EXPECT_TRUE(std::isnan(column(series, "three_sigma_m")[0]));
  EXPECT_NEAR(column(series, "three_sigma_m")[1], 1.5, 1e-12);
  EXPECT_NEAR(column(series, "three_sigma_deg")[2], 0.006 * 180.0 / M_PI, 1e-12);
}

TEST(RunSeries, IsThinnedWithoutLosingChangesOfTheStatusAndWorstFrames) {
  RunSeries series;
  SeriesColumn status{.name = "status", .values = {}};
  for (int i = 0; i < 1000; ++i) {
    series.t_s.push_back(0.1 * i);
    status.values.push_back(i == 503 ? 4.0 : i < 20 ? std::nan("") : 1.0);
  }
  series.columns = {status};
  series.worst = {777, 33};
  series.images = {{33, "image:33"}};
  const RunSeries thin = thinned(series, 100);
  ASSERT_EQ(thin.t_s.size(), thin.numbers.size());
  EXPECT_LT(thin.t_s.size(), 110u);
  for (std::size_t i = 0; i < thin.numbers.size(); ++i) EXPECT_EQ(thin.t_s[i], series.t_s[thin.numbers[i]]);
  EXPECT_EQ(thin.numbers.back(), 999u);
  EXPECT_EQ(std::ranges::count(column(thin, "status"), 4.0), 1);
  EXPECT_EQ(thin.numbers[thin.worst[0]], 777u);
  EXPECT_EQ(thin.numbers[thin.images.begin()->first], 33u);
  EXPECT_TRUE(thinned(series, 1000).numbers.empty());
}

TEST(RunSeries, ContainsTheTimesOfInjectedFaults) {
  const TemporaryFolder folder;
  fill_store(folder.path() / "s", {.variant = "vo", .sequence = "a"});
  const bench::Store store(folder.path() / "s");
  const std::vector<FaultBand> faults = run_series(store, store.runs().front()).faults;
  ASSERT_EQ(faults.size(), 2u);  // frames from 0 to 0.2 s: the third one would begin at 0.25 s
  EXPECT_NEAR(faults[1].begin_s, 0.15, 1e-9);
  EXPECT_NEAR(faults[1].end_s, 0.2, 1e-9);
  EXPECT_EQ(faults[1].fault, "blank:start=0.05,duration=0.05,every=0.1");
}

TEST(ReportSubject, HasThePublishedTablesThatItsPlansName) {
  const TemporaryFolder folder;
  fill_store(folder.path() / "s", {.variant = "vo", .sequence = "a"});
  EXPECT_EQ(report_subject(bench::Store(folder.path() / "s"), "").published, std::vector<std::string>());
  bench::StoreWriter(folder.path() / "s")
      .record_plan({.name = "q",
                    .title = "",
                    .text = "[table]\npublished = [\"tum_fr3_ate\", \"of_another_version\"]\n",
                    .run_keys = {bench::run_key({.variant = "vo", .sequence = "a"})}});
  EXPECT_EQ(report_subject(bench::Store(folder.path() / "s"), "").published,
            std::vector<std::string>{"tum_fr3_ate"});
}

TEST(ReportSubject, NamesTheRunsThatNoPlanHasAnyMore) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "s";
  const auto plan = [&](const std::string& variant) {
    bench::StoreWriter(file).record_plan(
        {.name = "p",
         .title = "",
         .text = "",
         .run_keys = {bench::run_key({.variant = variant, .sequence = "a"})}});
    return report_subject(bench::Store(file), "");
  };
  fill_store(file, {.variant = "vo", .sequence = "a"});
  EXPECT_EQ(unplanned_sentence(plan("vo")), "");
  fill_store(file, {.variant = "other", .sequence = "a"});
  const ReportSubject subject = plan("other");
  EXPECT_EQ(subject.runs.size(), 1u);
  EXPECT_EQ(unplanned_sentence(subject).find("1 run of these builds left out"), 0u);
  EXPECT_NE(report_html(bench::Store(file), subject).find("1 run of these builds left out"),
            std::string::npos);
  EXPECT_EQ(unplanned_sentence(report_subject(bench::Store(file), "p")), "");  // of this plan only
}

TEST(PlanArgument, IsAFileUnlessTheProgramHasThePlan) {
  const std::string text = bench::find_toml("quick", bench::TomlKind::kPlan).text;
  EXPECT_EQ(plan_argument({.name = "quick", .title = "", .text = text, .run_keys = {}}), "quick");
  EXPECT_EQ(plan_argument({.name = "quick", .title = "", .text = text + "#", .run_keys = {}}), "quick.toml");
  EXPECT_EQ(plan_argument({.name = "mine", .title = "", .text = text, .run_keys = {}}), "mine.toml");
}

TEST(ReportPage, NamesTheRunWithTheLargestErrorIfThereAreSeveral) {
  const TemporaryFolder folder;
  fill_store(folder.path() / "s", {.variant = "vo", .sequence = "a"});
  const auto page = [&] {
    const bench::Store store(folder.path() / "s");
    return report_html(store, report_subject(store, ""));
  };
  EXPECT_EQ(page().find("The run with the largest"), std::string::npos);
  fill_store(folder.path() / "s", {.variant = "<other>", .sequence = "a"});
  bench::StoreWriter(folder.path() / "s")
      .record_plan({.name = "p",
                    .title = "",
                    .text = "",
                    .run_keys = {bench::run_key({.variant = "vo", .sequence = "a"}),
                                 bench::run_key({.variant = "<other>", .sequence = "a"})}});
  EXPECT_NE(page().find("The run with the largest ATE (0.25 m) is <a href=\"#run="), std::string::npos);
}

TEST(RunSeries, ContainsRotationsAndAlignedLandmarksStaticOnesFirst) {
  const TemporaryFolder folder;
  fill_store(folder.path() / "s", {.variant = "vo", .sequence = "a"});
  const bench::Store store(folder.path() / "s");
  const RunSeries series = run_series(store, store.runs().front());
  ASSERT_EQ(series.landmarks.size(), 2u);
  EXPECT_FALSE(series.landmarks[0].dynamic);
  EXPECT_TRUE(series.landmarks[1].dynamic);
  // The estimate equals the ground truth, along x: the alignment keeps the coordinates along it.
  EXPECT_NEAR(series.landmarks[0].p_w.x(), 0.0, 1e-9);
  EXPECT_NEAR(series.landmarks[1].p_w.x(), 0.5, 1e-9);
  EXPECT_NEAR((series.landmarks[1].p_w - series.landmarks[0].p_w).norm(), 0.5, 1e-9);
  ASSERT_EQ(series.surfaces.size(), 2u);
  EXPECT_NEAR((series.surfaces[0].p.cast<double>() - series.landmarks[1].p_w).norm(), 0.0, 1e-6);
  EXPECT_TRUE(thinned(series, 2).surfaces.empty());
  for (const char* name : {"qx", "qy", "qz"})
    EXPECT_TRUE(std::ranges::any_of(series.columns, [&](const auto& column) { return column.name == name; }));
}

TEST(ReportPage, ContainsTheLoopsOfTheRunButNotThoseToALoadedMap) {
  const TemporaryFolder folder;
  fill_store(folder.path() / "s", {.variant = "vo", .sequence = "a"});
  const bench::Store store(folder.path() / "s");
  const std::vector<bench::StoredLoop> loops =
      bench::parse_loops(store.attachment(store.runs().front(), "loops"), "loops.csv");
  ASSERT_EQ(loops.size(), 3u);
  EXPECT_TRUE(loops[0].accepted);
  EXPECT_EQ(loops[1].reason, "few_inliers");
  EXPECT_TRUE(loops[2].in_map);
  const std::string page = report_html(store, report_subject(store, "p"));
  const std::size_t begin = page.find("\"loops\":[[");
  ASSERT_NE(begin, std::string::npos);
  const std::string embedded = page.substr(begin, page.find("]]", begin) - begin);
  EXPECT_NE(embedded.find(",60,1.5,\"\"]"), std::string::npos) << embedded;
  EXPECT_NE(embedded.find(",10,2.0,\"few_inliers\""), std::string::npos) << embedded;
  EXPECT_EQ(std::ranges::count(embedded, '['), 3) << embedded;  // the list and two loops
}

TEST(ReportPage, ContainsTheStaticSurfacesWithColorsOfFiveBits) {
  const TemporaryFolder folder;
  fill_store(folder.path() / "s", {.variant = "vo", .sequence = "a"});
  const bench::Store store(folder.path() / "s");
  const PageData data = page_data(store, store.runs(), RunData::kEmbedded);
  const nlohmann::json surfaces = nlohmann::json::parse(data.series.at(0)).at("surfaces");
  // 31 * 1024 + 16 * 32 + 1 is the larger one, 0 the other: numbers 65534 and 0.
  EXPECT_EQ(surfaces["color"]["low"], 0.0);
  EXPECT_EQ(surfaces["color"]["step"], 32257.0 / 65534.0);
  EXPECT_EQ(surfaces["color"]["data"], "/v8AAA==");
  EXPECT_EQ(surfaces["x"]["data"], "/v8AAA==");
}

TEST(ReportPage, ThinsTheStaticSurfacesInOneFileButNotInSideFiles) {
  const TemporaryFolder folder;
  std::vector<eval::CloudPoint> cloud(8000);
  for (int i = 0; i < 8000; ++i)
    cloud[static_cast<std::size_t>(i)].p = 0.1F * Eigen::Vector3i(i % 100, i / 100, 0).cast<float>();
  {
    bench::StoreWriter writer(folder.path() / "s");
    for (int seed = 1; seed <= 15; ++seed) {
      const bench::RunIdentity identity{.variant = "vo", .sequence = "a", .seed = seed};
      static_cast<void>(writer.acquire(identity));
      bench::RunOutcome outcome{.outcome = bench::Outcome::kOk};
      outcome.attachments = {{"trajectory", "1.0 0 0 0 0 0 0 1\n1.2 1 0 0 0 0 0 1\n"},
                             {"surfaces", eval::ply_bytes(cloud)}};
      writer.finish(identity, outcome);
    }
  }
  const bench::Store store(folder.path() / "s");
  const auto bytes_with = [&](RunData place) {
    std::size_t bytes = 0;
    for (const std::string& series : page_data(store, store.runs(), place).series) bytes += series.size();
    return bytes;
  };
  const std::size_t embedded = bytes_with(RunData::kEmbedded);
  EXPECT_LT(embedded, 420'000u);
  EXPECT_GT(embedded, 200'000u);
  EXPECT_GT(bytes_with(RunData::kSideFiles), 15u * 8000u * 10u);
}

TEST(ReportPage, IsAPureFunctionOfTheStore) {
  const TemporaryFolder folder;
  fill_store(folder.path() / "s", {.variant = "vo", .sequence = "a"});
  const bench::Store store(folder.path() / "s");
  const bench::Store again(folder.path() / "s");
  EXPECT_EQ(report_html(store, report_subject(store, "p")), report_html(again, report_subject(again, "")));
}

TEST(ReportPage, EscapesHostileNames) {
  const TemporaryFolder folder;
  const std::string hostile = "</script><img src=x onerror=alert(1)>\"'\xFF<!--data-->\\";
  fill_store(folder.path() / "s", {.variant = hostile, .sequence = hostile, .build = hostile}, hostile);
  const bench::Store store(folder.path() / "s");
  const std::string page = report_html(store, report_subject(store, ""));
  EXPECT_EQ(page.find("<img src"), std::string::npos);
  EXPECT_EQ(page.find("</script><b>"), std::string::npos);
  EXPECT_EQ(page.find("<!--"), std::string::npos);
}

TEST(ReportPage, HandlesTrajectoriesWithoutPosesAndWithASingleOne) {
  const TemporaryFolder folder;
  bench::StoreWriter writer(folder.path() / "s");
  for (const char* trajectory : {"# timestamp tx ty tz qx qy qz qw\n", "1.0 0 0 0 0 0 0 1\n"}) {
    const bench::RunIdentity identity{.variant = trajectory, .sequence = "market"};
    static_cast<void>(writer.acquire(identity));
    bench::RunOutcome outcome{.outcome = bench::Outcome::kLost, .detail = "no frame has a pose"};
    outcome.attachments = {{"trajectory", trajectory}, {"truth", "1.0 0 0 0 0 0 0 1\n2.0 1 0 0 0 0 0 1\n"}};
    writer.finish(identity, outcome);
  }
  const bench::Store store(folder.path() / "s");
  EXPECT_NE(report_html(store, report_subject(store, "")).find(">failed<"), std::string::npos);
}

TEST(ReportPage, ExplainsItsMetrics) {
  const TemporaryFolder folder;
  fill_store(folder.path() / "s", {.variant = "vo", .sequence = "a"});
  const bench::Store store(folder.path() / "s");
  const std::string page = report_html(store, report_subject(store, ""));
  const std::string text = bench::tooltip_of("ate_rmse_m");
  EXPECT_NE(page.find("<th scope=\"col\" title=\"" + text + "\">a [m]</th>"), std::string::npos);
  EXPECT_NE(page.find("<dt>ate_rmse_m, ATE</dt><dd>" + text + "</dd>"), std::string::npos);
}

TEST(ReportPage, HasNoExternalReferences) {
  const TemporaryFolder folder;
  fill_store(folder.path() / "s", {.variant = "vo", .sequence = "a"});
  const bench::Store store(folder.path() / "s");
  const std::string page = report_html(store, report_subject(store, ""));
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  for (const char* reference : {"src=\"http", "href=\"http", "url(http", "@import"}) {
    EXPECT_EQ(page.find(reference), std::string::npos) << reference;
  }
}

TEST(ReportPage, SizeWithoutDataIsBelowTheBudget) {
  const TemporaryFolder folder;
  fill_store(folder.path() / "s", {.variant = "vo", .sequence = "a"});
  const bench::Store store(folder.path() / "s");
  EXPECT_LT(report_html(store, report_subject(store, "")).size(), 600'000u);
}

TEST(ReportSubject, DoesNotMixBuilds) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "s";
  // The order of the regression gate: base, head, head, base. The first run of head is the later one.
  const std::vector<bench::RunIdentity> pairs = {
      {.variant = "vo", .sequence = "a", .build = "base", .repetition = 1},
      {.variant = "vo", .sequence = "a", .build = "head", .repetition = 1},
      {.variant = "vo", .sequence = "a", .build = "head", .repetition = 2},
      {.variant = "vo", .sequence = "a", .build = "base", .repetition = 2}};
  bench::StoreWriter writer(file);
  std::vector<std::string> keys;
  for (const bench::RunIdentity& identity : pairs) {
    static_cast<void>(writer.acquire(identity));
    writer.finish(identity, {.metrics = {{"ate_rmse_m", "", "m", identity.build == "head" ? 2.0 : 1.0}}});
    keys.push_back(bench::run_key(identity));
  }
  writer.record_plan({.name = "p", .title = "", .text = "", .run_keys = keys});
  const bench::Store store(file);
  const ReportSubject subject = report_subject(store, "p");
  ASSERT_EQ(subject.runs.size(), 2u);
  EXPECT_EQ(subject.other_runs.size(), 2u);
  EXPECT_EQ(report_tables(subject).front().rows[0].cells[0].number, 2.0);
  // Twice the error, but on the only seed: no test supports more than "inconclusive".
  EXPECT_NE(report_html(store, subject).find("Compared with build base: inconclusive; 2 pairs of runs"),
            std::string::npos);
}

/// `stillpoint store import` adds runs that no plan has.
TEST(ReportSubject, RunsOfSystemsInNoPlanAreShownBesideThePlans) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "s";
  fill_store(file, {.variant = "vo", .sequence = "a"});
  const std::size_t planned = report_subject(bench::Store(file), "").runs.size();
  {
    bench::StoreWriter writer(file);
    const bench::RunIdentity imported{
        .system = "orb_slam", .variant = "orb_slam", .sequence = "a", .build = "1"};
    static_cast<void>(writer.acquire(imported));
    writer.finish(imported, {.metrics = {{"ate_rmse_m", "", "m", 3.0}}});
  }
  const bench::Store store(file);
  const ReportSubject subject = report_subject(store, "");
  EXPECT_EQ(subject.runs.size(), planned + 1);
  EXPECT_EQ(report_tables(subject).front().rows.back().label, "orb_slam");
  EXPECT_EQ(report_subject(store, "p").runs.size(), planned);
}

TEST(ReportSubject, ErrorListsTheKnownPlans) {
  const TemporaryFolder folder;
  fill_store(folder.path() / "s", {.variant = "vo", .sequence = "a"});
  const bench::Store store(folder.path() / "s");
  expect_input_error([&] { static_cast<void>(report_subject(store, "q")); }, {"\"q\"", "p"});
}

TEST(Summary, NamesFailedRunsAndTheBestVariant) {
  bench::StoredRun good;
  good.identity = {.variant = "a", .sequence = "s"};
  good.metrics = {{"ate_rmse_m", "", "m", 1.0}};
  bench::StoredRun better = good;
  better.identity.variant = "b";
  better.metrics.front().value = 0.5;
  bench::StoredRun lost = good;
  lost.identity.variant = "c";
  lost.outcome = bench::Outcome::kLost;
  lost.detail = "no frame has a pose";
  const std::vector<bench::StoredRun> runs = {good, better, lost};
  const std::vector<std::string> sentences = outcome_sentences(runs);
  ASSERT_EQ(sentences.size(), 2u);
  EXPECT_EQ(sentences[0], "3 runs of 3 variants on 1 sequence: 1 run failed.");
  EXPECT_EQ(sentences[1], "c on s: lost, no frame has a pose.");
  EXPECT_EQ(best_sentence(runs),
            "b has the smallest median ATE on 1 of 1 sequences (n = 1; not a statement of significance).");
}

TEST(Summary, VariantsWithEqualErrorsAreBestTogether) {
  bench::StoredRun a;
  a.identity = {.variant = "a", .sequence = "s"};
  a.metrics = {{"ate_rmse_m", "", "m", 1.0}};
  bench::StoredRun b = a;
  b.identity.variant = "b";
  bench::StoredRun c = a;
  c.identity.variant = "c";
  c.metrics.front().value = 2.0;
  EXPECT_TRUE(
      best_sentence(std::vector{a, b, c}).starts_with("a, b each have the smallest median ATE on 1 of 1"))
      << best_sentence(std::vector{a, b, c});
}

TEST(Summary, AnErrorOverFewPosesIsNotTheSmallest) {
  bench::StoredRun whole;
  whole.identity = {.variant = "a", .sequence = "s"};
  whole.metrics = {{"ate_rmse_m", "", "m", 1.0}, {"coverage", "", "", 0.95}};
  bench::StoredRun started_later = whole;
  started_later.identity.variant = "b";
  started_later.metrics = {{"ate_rmse_m", "", "m", 0.8}, {"coverage", "", "", 0.85}};
  bench::StoredRun few = whole;
  few.identity.variant = "c";
  few.metrics = {{"ate_rmse_m", "", "m", 0.01}, {"coverage", "", "", 0.05}};
  EXPECT_TRUE(best_sentence(std::vector{whole, started_later, few}).starts_with("b has the smallest"));
  EXPECT_TRUE(best_sentence(std::vector{whole, few}).starts_with("a has the smallest"));
}

}  // namespace
}  // namespace stillpoint::report
