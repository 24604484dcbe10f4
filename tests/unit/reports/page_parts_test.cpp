// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/store/store_writer.h"
#include "reports/page/chart_data.h"
#include "reports/page/page_data.h"
#include "reports/page/report_page.h"
#include "reports/page/report_subject.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::report {
namespace {

/// A TUM file of 101 poses at 10 Hz along x; speed in m/s.
std::string straight(double speed) {
  std::string text;
  for (int i = 0; i <= 100; ++i)
    text += std::to_string(0.1 * i) + " " + std::to_string(speed * 0.1 * i) + " 0 0 0 0 0 1\n";
  return text;
}

void add_run(const std::filesystem::path& file, const bench::RunIdentity& identity,
             const bench::RunOutcome& outcome) {
  bench::StoreWriter writer(file);
  ASSERT_EQ(writer.acquire(identity), bench::RunLease::kGranted);
  writer.finish(identity, outcome);
}

/// A run whose ground truth is 10 m long and whose estimate is `scale` times as long.
bench::RunOutcome scaled_run(double scale) {
  bench::RunOutcome outcome;
  outcome.attachments = {{"trajectory", straight(scale)}, {"truth", straight(1.0)}};
  return outcome;
}

TEST(FlameStacks, AreSummedByStack) {
  const StackTimes times = parse_stacks("tracking;klt 5\ntracking 2\ntracking;klt 7\n", "a");
  EXPECT_EQ(times, (StackTimes{{"tracking", 2.0}, {"tracking;klt", 12.0}}));
}

TEST(FlameStacks, RejectInvalidLines) {
  expect_input_error([&] { static_cast<void>(parse_stacks("a 1\nb;c\n", "stacks of run 7")); },
                     {"stacks of run 7", "2"});
}

TEST(SegmentFigures, ErrorIsRelativeToTheSegmentLength) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "s";
  add_run(file, {.variant = "long", .sequence = "a"}, scaled_run(1.02));
  add_run(file, {.variant = "blind", .sequence = "a"}, {.outcome = bench::Outcome::kCrashed, .detail = "x"});
  const bench::Store store(file);
  const std::vector<SegmentFigure> figures = segment_figures(store, store.runs());
  ASSERT_EQ(figures.size(), 1U);
  ASSERT_EQ(figures[0].lengths_m.size(), 5U);
  EXPECT_NEAR(figures[0].lengths_m[4], 5.0, 1e-9);  // half of 10 m
  ASSERT_EQ(figures[0].curves.size(), 1U);          // no curve without poses
  for (const std::optional<double>& percent : figures[0].curves[0].translation_percent)
    EXPECT_NEAR(percent.value(), 2.0, 0.01);  // each meter is estimated as 1.02 m
}

TEST(OpenlorisOfRuns, TreatsTheSeedsOfASceneAsItsSequences) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "s";
  add_run(file, {.variant = "vo", .sequence = "market", .seed = 1}, scaled_run(1.0));
  add_run(file, {.variant = "vo", .sequence = "market", .seed = 2}, scaled_run(1.0));
  add_run(file, {.variant = "vo", .sequence = "walking_xyz"}, scaled_run(1.0));
  const bench::Store store(file);
  const eval::OpenlorisBenchmark benchmark = openloris_of_runs(store, store.runs());
  ASSERT_EQ(benchmark.gt_durations_s.size(), 1U);
  EXPECT_NEAR(benchmark.gt_durations_s.at("market").at(2), 10.0, 1e-9);
  EXPECT_NEAR(benchmark.systems.at("vo").at("market").score.figure_correct_rate, 1.0, 1e-9);
}

bench::StoredRun run_with_key(const std::string& key, const bench::RunIdentity& identity) {
  bench::StoredRun run;
  run.key = key;
  run.identity = identity;
  return run;
}

TEST(DisambiguateNames, AppendsThePlanToConflictingNames) {
  const std::vector<bench::StoredPlan> plans = {
      {.name = "p", .title = "", .text = "", .run_keys = {"1", "2"}},
      {.name = "q", .title = "", .text = "", .run_keys = {"3", "4"}}};
  const std::vector<bench::StoredRun> runs = {
      run_with_key("1", {.variant = "vo", .sequence = "a", .sequence_id = "8 s", .config_hash = "x"}),
      run_with_key("2", {.variant = "vio", .sequence = "a", .sequence_id = "8 s", .config_hash = "y"}),
      run_with_key("3", {.variant = "vo", .sequence = "b", .sequence_id = "b", .config_hash = "z"}),
      run_with_key("4", {.variant = "vio", .sequence = "a", .sequence_id = "20 s", .config_hash = "y"})};
  const std::vector<bench::StoredRun> result = renamed(runs, disambiguate_names(plans, runs));
  EXPECT_EQ(result[0].identity.variant, "vo");
  EXPECT_EQ(result[2].identity.variant, "vo (q)");  // z is not x
  EXPECT_EQ(result[3].identity.variant, "vio");     // y in both plans
  EXPECT_EQ(result[1].identity.sequence, "a");
  EXPECT_EQ(result[3].identity.sequence, "a (q)");
}

TEST(DisambiguateNames, IgnoresSeedsAndSweeps) {
  const std::vector<bench::StoredPlan> plans = {
      {.name = "p", .title = "", .text = "", .run_keys = {"1", "2"}},
      {.name = "q", .title = "", .text = "", .run_keys = {"3"}}};
  const std::vector<bench::StoredRun> runs = {
      run_with_key("1", {.variant = "vo", .config_hash = "x", .seed = 1}),
      run_with_key("2", {.variant = "vo", .config_hash = "y", .seed = 2}),
      run_with_key("3", {.variant = "vo", .config_hash = "z", .axis = "k", .axis_value = 3.0})};
  EXPECT_TRUE(disambiguate_names(plans, runs).variants.empty());
}

TEST(PageImages, IncludesTheWorstFrameOfEachRunFirst) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "s";
  bench::RunOutcome outcome;
  outcome.attachments = {{"image:000004", "foobar"}, {"image:000009", "barfoo"}};
  add_run(file, {.variant = "a"}, outcome);
  add_run(file, {.variant = "b"}, outcome);
  const bench::Store store(file);
  RunSeries series;
  series.worst = {9, 4};
  series.images = {{4, "image:000004"}, {9, "image:000009"}};
  // Six bytes take eight in base64: three of the four images fit.
  const std::vector<std::string> images = page_images(store, store.runs(), std::vector{series, series}, 30);
  ASSERT_EQ(images.size(), 2U);
  EXPECT_EQ(nlohmann::json::parse(images[0]), (nlohmann::json{{"9", "YmFyZm9v"}, {"4", "Zm9vYmFy"}}));
  EXPECT_EQ(nlohmann::json::parse(images[1]), (nlohmann::json{{"9", "YmFyZm9v"}}));
}

TEST(RunSeries, ListsTheWorstFramesThatHaveAnImage) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "s";
  bench::RunOutcome outcome;
  // The ground truth is at rest; the estimate jumps by 1 m at frame 11, by 3 m at 12, and is lost at 13.
  outcome.attachments["truth"] =
      "0.0 0 0 0 0 0 0 1\n0.1 0 0 0 0 0 0 1\n0.2 0 0 0 0 0 0 1\n0.3 0 0 0 0 0 0 1\n";
  outcome.attachments["trajectory"] = "0.0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 1\n0.2 4 0 0 0 0 0 1\n";
  outcome.attachments["counters"] =
      "frame,t_ns,status,tracked_features,window_landmarks,depth_landmarks,dynamic_features,"
      "solver_iterations,keyframe,reset\n10,0,tracking,9,9,9,0,3,1,0\n11,100000000,tracking,9,9,9,0,3,1,0\n"
      "12,200000000,tracking,9,9,9,0,3,1,0\n13,300000000,lost,0,0,0,0,0,0,0\n";
  add_run(file, {.variant = "all"}, outcome);
  outcome.attachments["image:000011"] = "jpeg";
  add_run(file, {.variant = "with images"}, outcome);
  const bench::Store store(file);
  EXPECT_EQ(run_series(store, store.runs()[0]).worst, (std::vector<std::size_t>{3, 2, 1}));
  const RunSeries with_images = run_series(store, store.runs()[1]);
  EXPECT_EQ(with_images.worst, (std::vector<std::size_t>{1}));  // the index of frame 11
  EXPECT_EQ(with_images.images.at(1), "image:000011");
}

}  // namespace
}  // namespace stillpoint::report
