// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/faulty_stream.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

/// 5 s at 10 Hz: image and depth of frame i contain i + 1; IMU at 100 Hz; one empty set of boxes per frame.
class NumberedStream final : public SensorStream {
 public:
  NumberedStream() {
    info_.folder = "numbered";
    info_.rig.camera = {.width = kWidth, .height = kHeight, .fx = 50.0, .fy = 50.0, .cx = 31.5, .cy = 23.5};
    info_.rig.has_imu = true;
    for (int i = 0; i < 50; ++i) {
      info_.frame_times.push_back(from_seconds(100.0 + 0.1 * i));
      info_.detections.push_back(
          {.t = info_.frame_times.back(), .state = DetectionState::kPresent, .detections = {}});
    }
    for (int i = 0; i < 500; ++i) {
      info_.imu.push_back({.t = from_seconds(100.0 + 0.01 * i),
                           .gyro_b = Eigen::Vector3d(0.1, -0.9, 0.2),
                           .accel_b = Eigen::Vector3d(0.0, 0.0, 9.81)});
    }
  }
  [[nodiscard]] const SequenceInfo& info() const override { return info_; }
  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    const int value = static_cast<int>(index) + 1;
    return {.id = static_cast<std::int64_t>(index),
            .t = info_.frame_times[index],
            .gray = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(value)),
            .color = cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar::all(value)),
            .depth = cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(1000 + value))};
  }
  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t) const override { return std::nullopt; }

 private:
  SequenceInfo info_;
};

std::unique_ptr<SensorStream> stream_with(const std::string& fault) {
  return with_faults(std::make_unique<NumberedStream>(), {parse_fault(fault)});
}

bool equal(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

TEST(FaultyStream, ChangesOnlyTheFramesOfTheInterval) {
  const NumberedStream source;
  for (const FaultDescriptor& descriptor : fault_descriptors()) {
    if (descriptor.target != FaultTarget::kImages && descriptor.target != FaultTarget::kDepth) continue;
    if (descriptor.kind == FaultKind::kDropped) continue;
    const auto stream = stream_with(std::string(descriptor.name) + ":start=2,duration=1");
    for (const std::size_t index : {0U, 19U, 30U, 49U}) {
      const Frame frame = stream->load_frame(index);
      const Frame original = source.load_frame(index);
      EXPECT_TRUE(equal(frame.gray, original.gray) && equal(frame.color, original.color) &&
                  equal(frame.depth, original.depth))
          << descriptor.name << " frame " << index;
    }
  }
}

TEST(FaultyStream, DoesNotWriteIntoImagesOfTheSource) {
  Frame original = NumberedStream().load_frame(20);
  const cv::Mat gray = original.gray.clone();
  const cv::Mat depth = original.depth.clone();
  class OneFrame final : public SensorStream {
   public:
    explicit OneFrame(Frame frame) : frame_(std::move(frame)) {
      info_.frame_times = {frame_.t};
      info_.imu = {{.t = frame_.t}};
    }
    [[nodiscard]] const SequenceInfo& info() const override { return info_; }
    [[nodiscard]] Frame load_frame(std::size_t) const override { return frame_; }
    [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t) const override { return std::nullopt; }

   private:
    Frame frame_;
    SequenceInfo info_;
  };
  for (const FaultDescriptor& descriptor : fault_descriptors()) {
    if (descriptor.target != FaultTarget::kImages && descriptor.target != FaultTarget::kDepth) continue;
    if (descriptor.kind == FaultKind::kDropped) continue;
    const auto stream = with_faults(std::make_unique<OneFrame>(original),
                                    {parse_fault(std::string(descriptor.name) + ":start=0,duration=9")});
    static_cast<void>(stream->load_frame(0));
    EXPECT_TRUE(equal(original.gray, gray) && equal(original.depth, depth)) << descriptor.name;
  }
}

TEST(FaultyStream, BlanksFreezesAndRemovesDepth) {
  EXPECT_EQ(cv::sum(stream_with("blank:start=2")->load_frame(25).gray)[0], 0.0);
  EXPECT_EQ(stream_with("blank:start=2,amount=255")->load_frame(25).color.at<cv::Vec3b>(3, 4),
            cv::Vec3b(255, 255, 255));
  const Frame frozen = stream_with("frozen:start=2")->load_frame(25);
  EXPECT_EQ(frozen.gray.at<std::uint8_t>(0, 0), 20);  // frame 19
  EXPECT_EQ(frozen.t, from_seconds(102.5));
  EXPECT_EQ(stream_with("depth_previous:start=2")->load_frame(25).depth.at<std::uint16_t>(0, 0), 1025);
  EXPECT_EQ(cv::countNonZero(stream_with("depth_missing:start=2")->load_frame(25).depth), 0);
  EXPECT_EQ(stream_with("depth_scaled:start=2,amount=2")->load_frame(25).depth.at<std::uint16_t>(0, 0), 2052);
}

TEST(FaultyStream, DeferredColorImagesHaveTheFaultsOfOtherColorImages) {
  class Deferred final : public SensorStream {
   public:
    [[nodiscard]] const SequenceInfo& info() const override { return stream_.info(); }
    [[nodiscard]] Frame load_frame(std::size_t index) const override {
      Frame frame = stream_.load_frame(index);
      frame.decode_color = [color = frame.color] { return color; };
      frame.color = cv::Mat();
      return frame;
    }
    [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t) const override { return std::nullopt; }

   private:
    NumberedStream stream_;
  };
  for (const FaultDescriptor& descriptor : fault_descriptors()) {
    if (descriptor.kind == FaultKind::kDropped) continue;
    if (descriptor.target != FaultTarget::kImages && descriptor.target != FaultTarget::kDepth) continue;
    const std::string fault = std::string(descriptor.name) + ":start=2,duration=1";
    const auto deferred = with_faults(std::make_unique<Deferred>(), {parse_fault(fault)});
    EXPECT_TRUE(equal(color_image(deferred->load_frame(25)), stream_with(fault)->load_frame(25).color))
        << fault;
  }
}

TEST(FaultyStream, CoversTheRequestedFraction) {
  const Frame occluded = stream_with("occluder:start=2,amount=0.75")->load_frame(25);
  EXPECT_EQ(cv::countNonZero(occluded.depth == 450), kWidth * kHeight * 3 / 4);
  const Frame holes = stream_with("depth_holes:start=2,amount=0.5,duration=2")->load_frame(25);
  const double fraction = 1.0 - cv::countNonZero(holes.depth) / static_cast<double>(kWidth * kHeight);
  EXPECT_GT(fraction, 0.1);
  EXPECT_LT(fraction, 0.9);
}

TEST(FaultyStream, DropsFramesAndKeepsTheirStamps) {
  const auto stream = stream_with("dropped:start=2,duration=1");
  ASSERT_EQ(stream->info().frame_times.size(), 40U);
  const Frame frame = stream->load_frame(20);
  EXPECT_EQ(frame.id, 20);
  EXPECT_EQ(frame.t, from_seconds(103.0));
  EXPECT_EQ(frame.gray.at<std::uint8_t>(0, 0), 31);
  const std::size_t some = stream_with("dropped:start=0,duration=5,amount=0.5")->info().frame_times.size();
  EXPECT_GT(some, 10U);
  EXPECT_LT(some, 40U);
  EXPECT_THROW(static_cast<void>(stream_with("dropped:start=0,duration=9")), InputError);
}

TEST(FaultyStream, ChangesInertialSamplesOfTheInterval) {
  EXPECT_EQ(stream_with("imu_gap:start=2")->info().imu.size(), 400U);
  EXPECT_EQ(stream_with("imu_rate:start=2,amount=20")->info().imu.size(), 420U);
  const auto value_at = [](const std::string& fault, std::size_t index) {
    return stream_with(fault)->info().imu[index];
  };
  EXPECT_EQ(value_at("gyro_saturated:start=2,amount=0.5", 250).gyro_b, Eigen::Vector3d(0.1, -0.5, 0.2));
  EXPECT_EQ(value_at("gyro_saturated:start=2,amount=0.5", 350).gyro_b, Eigen::Vector3d(0.1, -0.9, 0.2));
  EXPECT_NEAR((value_at("shock:start=2,amount=8", 250).accel_b - Eigen::Vector3d(0.0, 0.0, 9.81)).norm(), 8.0,
              1e-12);
  EXPECT_EQ(value_at("clock_jump:start=2,amount=0.5", 199).t, from_seconds(101.99));
  EXPECT_EQ(value_at("clock_jump:start=2,amount=0.5", 499).t, from_seconds(105.49));
}

TEST(FaultyStream, KeepsSamplesInOrder) {
  for (const char* fault : {"imu_jitter:start=0,duration=5,amount=0.05", "time_offset:start=2,amount=0.3",
                            "time_offset:start=2,amount=-0.3"}) {
    const auto stream = stream_with(fault);
    const std::vector<ImuSample>& samples = stream->info().imu;
    for (std::size_t i = 1; i < samples.size(); ++i) ASSERT_LT(samples[i - 1].t, samples[i].t) << fault;
  }
}

TEST(FaultyStream, ChangesRecordedBoxes) {
  const auto set_at = [](const std::string& fault, std::size_t index) {
    return stream_with(fault)->info().detections[index];
  };
  EXPECT_EQ(set_at("detector_silent:start=2", 25).state, DetectionState::kNone);
  EXPECT_EQ(set_at("detector_late:start=2", 25).state, DetectionState::kLate);
  EXPECT_EQ(set_at("detector_late:start=2", 35).state, DetectionState::kPresent);
  EXPECT_EQ(set_at("detector_hallucinating:start=2,amount=3", 25).detections.size(), 3U);
}

TEST(FaultyStream, ChangesResultsOfADetectorAsRecordedBoxes) {
  for (const char* fault :
       {"detector_silent:start=2", "detector_late:start=2", "detector_hallucinating:start=2,amount=3"}) {
    const auto stream = stream_with(fault);
    const DetectionSet& recorded = stream->info().detections[25];
    const DetectionSet found = stream->info().change_detections(
        {.t = recorded.t, .state = DetectionState::kPresent, .detections = {}});
    EXPECT_EQ(found.state, recorded.state) << fault;
    ASSERT_EQ(found.detections.size(), recorded.detections.size()) << fault;
    for (std::size_t i = 0; i < found.detections.size(); ++i)
      EXPECT_EQ(found.detections[i].box.x_min, recorded.detections[i].box.x_min) << fault;
  }
}

TEST(FaultyStream, ChangesTheArrivalOfFrames) {
  EXPECT_TRUE(stream_with("blank")->info().arrivals.empty());
  const auto late = stream_with("frame_late:start=2,duration=1,amount=0.25")->info();
  ASSERT_EQ(late.arrivals.size(), late.frame_times.size());
  EXPECT_EQ(late.arrivals[25].index, 25U);
  EXPECT_EQ(late.arrivals[25].t, after(late.frame_times[25], 0.25));
  EXPECT_EQ(late.arrivals[31].index, 29U);  // after frames 30 and 31
  const auto swapped = stream_with("frame_reordered:start=2,duration=0.1,amount=1")->info();
  EXPECT_EQ(swapped.arrivals[20].index, 21U);
  EXPECT_EQ(swapped.arrivals[21].index, 20U);
  const auto repeated = stream_with("frame_duplicated:start=2,duration=0.1,amount=1")->info();
  ASSERT_EQ(repeated.arrivals.size(), repeated.frame_times.size() + 1);
  EXPECT_EQ(repeated.arrivals[22].index, 20U);
}

TEST(FaultyStream, IsAFunctionOfItsFaults) {
  for (const FaultDescriptor& descriptor : fault_descriptors()) {
    const bool has_schedule = descriptor.target != FaultTarget::kCalibration;
    const auto text =
        std::string(descriptor.name) + (has_schedule ? ":start=1,duration=2,seed=5" : ":seed=5");
    const auto one = stream_with(text);
    const auto other = stream_with(text);
    const std::size_t index = one->info().frame_times.size() / 2;
    static_cast<void>(one->load_frame(0));  // the order of loading does not matter
    EXPECT_TRUE(equal(one->load_frame(index).gray, other->load_frame(index).gray)) << text;
    ASSERT_EQ(one->info().imu.size(), other->info().imu.size()) << text;
    for (std::size_t i = 0; i < one->info().imu.size(); ++i)
      ASSERT_EQ(one->info().imu[i].accel_b, other->info().imu[i].accel_b) << text;
  }
}

TEST(FaultyStream, RejectsFaultsOfMissingData) {
  class WithoutImu final : public SensorStream {
   public:
    WithoutImu() { info_.frame_times = {from_seconds(1.0)}; }
    [[nodiscard]] const SequenceInfo& info() const override { return info_; }
    [[nodiscard]] Frame load_frame(std::size_t) const override { return {}; }
    [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t) const override { return std::nullopt; }

   private:
    SequenceInfo info_;
  };
  for (const char* fault : {"shock", "imu_gap"})
    EXPECT_THROW(static_cast<void>(with_faults(std::make_unique<WithoutImu>(), {parse_fault(fault)})),
                 InputError);
}

TEST(FaultIntervals, CoverTheSequence) {
  const std::vector<FaultInterval> intervals = fault_intervals(
      parse_fault("blank:start=1,duration=0.5,every=2"), from_seconds(100.0), from_seconds(104.9));
  ASSERT_EQ(intervals.size(), 2U);
  EXPECT_EQ(intervals[1].begin, from_seconds(103.0));
  EXPECT_EQ(intervals[1].end, from_seconds(103.5));
}

}  // namespace
}  // namespace stillpoint::datasets
