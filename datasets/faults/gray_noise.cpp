// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/gray_noise.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint::datasets {
namespace {

constexpr std::uint64_t kBitsPerPixel = 12;  // as `normal_from_bits` takes
constexpr std::uint64_t kPixelsPerDraw = 5;
constexpr std::size_t kLevels = std::size_t{1} << kBitsPerPixel;

class NoisyStream final : public SensorStream {
 public:
  NoisyStream(std::unique_ptr<SensorStream> stream, int seed)
      : stream_(std::move(stream)), info_(stream_->info()), seed_(static_cast<std::uint64_t>(seed)) {
    for (std::size_t bits = 0; bits < kLevels; ++bits)
      levels_[bits] = static_cast<std::int8_t>(std::lround(synth::normal_from_bits(bits)));
    info_.notes.push_back(fmt::format("noise of a gray level, seed {}", seed));
  }

  [[nodiscard]] const SequenceInfo& info() const override { return info_; }

  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    Frame frame = stream_->load_frame(index);
    frame.gray = frame.gray.clone();
    const std::uint64_t key =
        synth::random_key(seed_, synth::RandomStream::kGrayNoise, static_cast<std::uint64_t>(frame.t.ns));
    std::uint64_t pixel = 0;
    std::uint64_t bits = 0;
    for (int row = 0; row < frame.gray.rows; ++row) {
      std::uint8_t* values = frame.gray.ptr<std::uint8_t>(row);
      for (int column = 0; column < frame.gray.cols; ++column, ++pixel, bits >>= kBitsPerPixel) {
        if (pixel % kPixelsPerDraw == 0) bits = mix_bits(key + pixel / kPixelsPerDraw);
        values[column] = cv::saturate_cast<std::uint8_t>(values[column] + levels_[bits % kLevels]);
      }
    }
    return frame;
  }

  [[nodiscard]] bool frames_are_cached() const override { return stream_->frames_are_cached(); }

  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t index) const override {
    return stream_->load_labels(index);
  }

 private:
  std::unique_ptr<SensorStream> stream_;
  SequenceInfo info_;
  std::uint64_t seed_;
  std::array<std::int8_t, kLevels> levels_{};
};

}  // namespace

std::unique_ptr<SensorStream> with_gray_noise(std::unique_ptr<SensorStream> stream, int seed) {
  if (seed == 0) return stream;
  return std::make_unique<NoisyStream>(std::move(stream), seed);
}

}  // namespace stillpoint::datasets
