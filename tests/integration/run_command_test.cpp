// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint run`: output files, modes and error handling.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "eval/io/ply_file.h"
#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 90;  // 3 s at 30 Hz

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

nlohmann::json json_of(const fs::path& file) { return nlohmann::json::parse(text_of(file)); }

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Arguments of `run` for a sequence.
std::vector<std::string> run_of(const fs::path& sequence, const fs::path& out,
                                const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"run", sequence.string(), "--out", out.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(RunCommand, WritesTrajectoryResultAndManifest) {
  const TemporaryFolder out;
  const ProgramResult result = run_program(run_of(rendered_sequence(), out.path()));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(names_in(out.path()),
            (std::vector<std::string>{"counters.csv", "frames.csv", "manifest.json", "result.json",
                                      "stacks.folded", "status.csv", "timings.csv", "trajectory.tum"}));
  const nlohmann::json scores = json_of(out.path() / "result.json");
  EXPECT_EQ(scores["status"], "ok");
  EXPECT_EQ(scores["frames"], kFrames);
  EXPECT_GT(scores["coverage"], 0.5);
  EXPECT_LT(scores["ate_rmse_m"], 0.05);  // a sanity bound; accuracy is tested at full resolution
  EXPECT_GT(scores["timings"]["modules"]["state_optimization"]["median"], 0.0);
  EXPECT_EQ(scores["timings"]["threads"]["tracking_thread"]["calls"], kFrames);
  EXPECT_EQ(scores["timings"]["modules"]["image_decoding"]["calls"], kFrames);
  const nlohmann::json manifest = json_of(out.path() / "manifest.json");
  EXPECT_EQ(manifest["sequence"]["checksum"].get<std::string>().size(), 16u);
  EXPECT_EQ(manifest["config"]["resolved"]["imu.enabled"], true);
  EXPECT_FALSE(manifest["build"]["git_commit"].get<std::string>().empty());
}

TEST(RunCommand, IsBitEqualInTwoRunsAndWithTwoPoolThreads) {
  const TemporaryFolder out;
  for (const char* name : {"first", "second"}) {
    ASSERT_EQ(run_program(run_of(rendered_sequence(), out.path() / name)).exit_code, 0);
  }
  ASSERT_EQ(
      run_program(run_of(rendered_sequence(), out.path() / "pool", {"--set", "frontend.grid.threads=2"}))
          .exit_code,
      0);
  const std::string first = text_of(out.path() / "first" / "trajectory.tum");
  EXPECT_GT(first.size(), 1000u);
  EXPECT_EQ(first, text_of(out.path() / "second" / "trajectory.tum"));
  EXPECT_EQ(first, text_of(out.path() / "pool" / "trajectory.tum"));
}

TEST(RunCommand, PipelinedAndSequentialModeWriteEqualTrajectories) {
  const TemporaryFolder out;
  for (const char* mode : {"sequential", "pipelined"}) {
    ASSERT_EQ(run_program(run_of(rendered_sequence(), out.path() / mode,
                                 {"--mode", mode, "--set", "pipeline.feedback_lag=1"}))
                  .exit_code,
              0);
  }
  EXPECT_EQ(text_of(out.path() / "sequential" / "trajectory.tum"),
            text_of(out.path() / "pipelined" / "trajectory.tum"));
}

TEST(RunCommand, RealtimeModeReportsLatency) {
  const TemporaryFolder out;
  ASSERT_EQ(
      run_program(run_of(rendered_sequence(), out.path(), {"--mode", "realtime", "--speed", "4"})).exit_code,
      0);
  const nlohmann::json realtime = json_of(out.path() / "result.json")["realtime"];
  EXPECT_NEAR(realtime["deadline_ms"], 1e3 / 30.0 / 4.0, 0.01);
  EXPECT_GT(realtime["latency_ms"]["p50"], 0.0);
  EXPECT_LE(realtime["latency_ms"]["p50"], realtime["latency_ms"]["p99"]);
}

TEST(RunCommand, ALateStartLeavesOutTheFramesBeforeIt) {
  const TemporaryFolder out;
  const auto run_from = [&](const std::string& start_s) {
    return run_program(run_of(rendered_sequence(), out.path(), {"--start", start_s}));
  };
  const ProgramResult late = run_from("1");
  ASSERT_EQ(late.exit_code, 0) << late.err;
  // 30 of the 90 frames at 30 Hz are earlier than 1 s after the first one.
  const nlohmann::json scores = json_of(out.path() / "result.json");
  EXPECT_EQ(scores["frames"], kFrames - 30);
  EXPECT_GT(scores["coverage"], 0.5);
  EXPECT_LT(scores["ate_rmse_m"], 0.05);
  EXPECT_NE(scores["notes"].dump().find("begins 1 s after the first frame"), std::string::npos);
  const ProgramResult past = run_from("3");
  EXPECT_EQ(past.exit_code, 2);
  EXPECT_NE(past.err.find("--start: 3 s is past the end of office"), std::string::npos) << past.err;
}

TEST(RunCommand, PlaysEveryNthFrameFromTheStartOn) {
  const TemporaryFolder out;
  const ProgramResult run = run_program(
      run_of(rendered_sequence(), out.path(), {"--start", "1", "--every", "3", "--max-frames", "15"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // Of 60 frames from 1 s on 20 are played, of these the first 15.
  const nlohmann::json scores = json_of(out.path() / "result.json");
  EXPECT_EQ(scores["frames"], 15);
  EXPECT_LT(scores["ate_rmse_m"], 0.05);
  EXPECT_NE(scores["notes"].dump().find("1 of 3 frames is played: 20 of 60"), std::string::npos);
}

TEST(RunCommand, DumpsAllLabels) {
  const TemporaryFolder out;
  ASSERT_EQ(run_program(run_of(rendered_sequence(), out.path(), {"--dump", "labels", "--max-frames", "20"}))
                .exit_code,
            0);
  const std::string dump = text_of(out.path() / "labels.csv");
  EXPECT_TRUE(dump.starts_with("frame,t,id,u_px,v_px,depth_m,age,label,reason,residual_px\n"));
  EXPECT_GT(std::count(dump.begin(), dump.end(), '\n'), 20 * 20);  // more than 20 features per frame
  EXPECT_NE(dump.find(",stable,none,"), std::string::npos);
}

TEST(RunCommand, WritesAnnotatedFramesAndAVideo) {
  const TemporaryFolder out;
  const std::string video = (out.path() / "video").string();
  ASSERT_EQ(
      run_program(run_of(rendered_sequence(), out.path() / "run", {"--video", video, "--max-frames", "20"}))
          .exit_code,
      0);
  EXPECT_EQ(names_in(out.path() / "video"), (std::vector<std::string>{"frames", "video.mp4"}));
  EXPECT_EQ(names_in(out.path() / "video" / "frames").size(), 20u);
}

TEST(RunCommand, WritesImagesOfTheWorstFramesOnly) {
  const TemporaryFolder out;
  const ProgramResult result = run_program(run_of(rendered_sequence(), out.path(), {"--images", "3"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(names_in(out.path() / "images").size(), 3u);
  EXPECT_TRUE(std::filesystem::exists(out.path() / "landmarks.csv"));
  EXPECT_GT(eval::read_ply(out.path() / "surfaces.ply").size(), 500u);
}

TEST(RunCommand, RemovesWhatOnlyAnEarlierRunWrote) {
  const TemporaryFolder out;
  const auto run = [&](std::vector<std::string> options) {
    options.emplace_back("--force");
    return run_program(run_of(rendered_sequence(), out.path(), options)).exit_code;
  };
  ASSERT_EQ(run({"--max-frames", "20"}), 0);
  const std::vector<std::string> names = names_in(out.path());
  ASSERT_EQ(run({"--max-frames", "40", "--images", "1", "--dump", "labels", "--imu-rate"}), 0);
  EXPECT_EQ(names_in(out.path()).size(), names.size() + 5);
  out.write("notes.txt", "of the user");
  ASSERT_EQ(run({"--max-frames", "20"}), 0);
  EXPECT_TRUE(std::filesystem::remove(out.path() / "notes.txt"));
  EXPECT_EQ(names_in(out.path()), names);
}

TEST(RunCommand, ImagesAreReplacedWhenTheNewRunHasEnded) {
  const TemporaryFolder out;
  const auto run = [&](std::vector<std::string> options) {
    options.insert(options.end(), {"--max-frames", "20", "--force"});
    return run_program(run_of(rendered_sequence(), out.path(), options)).exit_code;
  };
  ASSERT_EQ(run({"--images", "3"}), 0);
  const std::vector<std::string> images = names_in(out.path() / "images");
  ASSERT_EQ(images.size(), 3u);
  const std::string heartbeat = (out.path() / "none" / "heartbeat").string();  // ends the run after its begin
  for (const char* count : {"0", "1"}) {
    EXPECT_EQ(run({"--images", count, "--heartbeat", heartbeat}), 2);
    EXPECT_EQ(names_in(out.path() / "images"), images);
    EXPECT_FALSE(fs::exists(out.path() / "images.new"));
  }
  ASSERT_EQ(run({"--images", "1"}), 0);
  EXPECT_EQ(names_in(out.path() / "images").size(), 1u);
  EXPECT_FALSE(fs::exists(out.path() / "images.new"));
}

TEST(RunCommand, WritesEachVariantToItsOwnFolder) {
  const TemporaryFolder out;
  const ProgramResult result = run_program(
      run_of(rendered_sequence(), out.path(),
             {"--variant", "vo", "--variant", "ablations/wo_circular_mask+vo", "--max-frames", "20"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(names_in(out.path()), (std::vector<std::string>{"ablations-wo_circular_mask+vo", "vo"}));
  const nlohmann::json manifest =
      json_of(out.path() / "ablations-wo_circular_mask+vo" / "manifest.json")["config"]["resolved"];
  EXPECT_EQ(manifest["imu.enabled"], false);
  EXPECT_EQ(manifest["frontend.circular_mask"], false);
  EXPECT_EQ(json_of(out.path() / "vo" / "result.json")["frames"], 20);
}

TEST(RunCommand, SkipsAndReportsAnUnreadableImage) {
  const TemporaryFolder folder;
  const fs::path sequence = copy_of_rendered_sequence(folder);
  const fs::path image = sequence / "color" / names_in(sequence / "color")[40];
  fs::remove(image);
  folder.write("copy/color/" + image.filename().string(), "not an image");
  const ProgramResult result = run_program(run_of(sequence, folder.path() / "out", {"--variant", "vo"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("warning: frame 40 skipped: " + image.string()), std::string::npos) << result.err;
  const nlohmann::json skipped = json_of(folder.path() / "out" / "result.json")["skipped_frames"];
  ASSERT_EQ(skipped.size(), 1u);
  EXPECT_EQ(skipped[0]["index"], 40);
}

TEST(RunCommand, CtrlCWritesAPartialResultThatIsMarkedAsInterrupted) {
  const TemporaryFolder out;
  std::vector<std::string> arguments = {"--verbose"};
  const std::vector<std::string> run = run_of(rendered_sequence(), out.path(), {"--variant", "vo"});
  arguments.insert(arguments.end(), run.begin(), run.end());
  ProgramOptions options;
  options.interrupt_after = "frame 5:";
  const ProgramResult result = run_program(arguments, options);
  EXPECT_EQ(result.exit_code, 130);
  const nlohmann::json scores = json_of(out.path() / "result.json");
  EXPECT_EQ(scores["status"], "interrupted");
  EXPECT_GE(scores["frames"], 6);
  EXPECT_LT(scores["frames"], kFrames);
  EXPECT_TRUE(text_of(out.path() / "trajectory.tum").starts_with("# partial: interrupted after "));
}

}  // namespace
}  // namespace stillpoint
