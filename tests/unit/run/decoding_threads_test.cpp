// SPDX-License-Identifier: BSD-3-Clause
// Which threads load the frames of a run.
#include <array>
#include <mutex>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <pthread.h>

#include "bench/run/odometry_run.h"

namespace stillpoint::bench {
namespace {

constexpr int kFrames = 10;

/// A camera at rest that records the names of the threads that load its frames.
class WatchedStream final : public datasets::SensorStream {
 public:
  explicit WatchedStream(bool cached) : cached_(cached) {
    info_.rig.camera = {.width = 320, .height = 240, .fx = 300.0, .fy = 300.0, .cx = 160.0, .cy = 120.0};
    for (int i = 0; i < kFrames; ++i) info_.frame_times.push_back(from_seconds(1.0 + 0.033 * i));
  }
  [[nodiscard]] const datasets::SequenceInfo& info() const override { return info_; }
  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    std::array<char, 16> name{};
    pthread_getname_np(pthread_self(), name.data(), name.size());
    const std::scoped_lock lock(mutex_);
    threads_.insert(name.data());
    Frame frame{.id = static_cast<std::int64_t>(index), .t = info_.frame_times[index]};
    frame.gray = cv::Mat(240, 320, CV_8UC1, cv::Scalar(128));
    return frame;
  }
  [[nodiscard]] bool frames_are_cached() const override { return cached_; }
  [[nodiscard]] std::optional<datasets::MotionLabels> load_labels(std::size_t) const override {
    return std::nullopt;
  }
  [[nodiscard]] const std::set<std::string>& threads() const { return threads_; }

 private:
  bool cached_;
  datasets::SequenceInfo info_;
  mutable std::mutex mutex_;
  mutable std::set<std::string> threads_;
};

std::set<std::string> loading_threads(const std::string& mode, bool cached) {
  const WatchedStream stream(cached);
  RunSpec spec{.mode = mode, .speed = 20.0};
  spec.config.imu.enabled = false;
  spec.config.detector.kind = DetectorKind::kNone;
  static_cast<void>(run_odometry(stream, spec, {}));
  return stream.threads();
}

TEST(DecodingThreads, RealTimeReadsCachedFramesOnTheThreadOfTheCamera) {
  EXPECT_EQ(loading_threads("realtime", true), std::set<std::string>{"camera"});
}

TEST(DecodingThreads, OtherwiseFramesAreLoadedAhead) {
  const std::set<std::string> decoding = {"decoding"};
  EXPECT_EQ(loading_threads("realtime", false), decoding);
  EXPECT_EQ(loading_threads("sequential", true), decoding);
  EXPECT_EQ(loading_threads("sequential", false), decoding);
}

}  // namespace
}  // namespace stillpoint::bench
