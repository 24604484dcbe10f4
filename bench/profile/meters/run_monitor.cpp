// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/run_monitor.h"

#include <cmath>
#include <utility>

#include "core/base/thread_name.h"

namespace stillpoint::bench {
namespace {

constexpr std::chrono::seconds kIdleTime{1};
constexpr std::chrono::milliseconds kSampleInterval{50};

/// Energy above idle per frame between two samples; nothing without frames.
std::optional<double> joules_per_frame(const EnergySample& from, const EnergySample& to, double idle_w) {
  if (to.frames <= from.frames) return std::nullopt;
  const double joules = to.joules - from.joules - idle_w * (to.t_s - from.t_s);
  return joules / static_cast<double>(to.frames - from.frames);
}

/// Standard deviation of the energy per frame over intervals of 1 s; nothing with less than two.
std::optional<double> spread(std::span<const EnergySample> samples, double idle_w) {
  std::vector<double> values;
  const EnergySample* from = &samples.front();
  for (const EnergySample& sample : samples) {
    if (sample.t_s - from->t_s < 1.0) continue;
    if (const auto value = joules_per_frame(*from, sample, idle_w)) values.push_back(*value);
    from = &sample;
  }
  if (values.size() < 2) return std::nullopt;
  double mean = 0.0, squares = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

}  // namespace

EnergyMeter::EnergyMeter(std::filesystem::path root, std::filesystem::path tegrastats, Time now)
    : root_(std::move(root)), tegrastats_(std::move(tegrastats)), source_("RAPL"), last_(now) {
  counters_ = read_rapl(root_);
  if (joules_between(counters_, counters_)) return;
  counters_.clear();
  power_w_ = power_w();
  is_valid_ = power_w_.has_value();
}

std::optional<double> EnergyMeter::power_w() {
  source_ = "INA3221";
  const std::vector<RailPower> sensors = read_power_sensors(root_);
  if (!sensors.empty() || tegrastats_.empty()) return device_power_w(sensors);
  source_ = "tegrastats";
  return device_power_w(read_tegrastats(tegrastats_));
}

void EnergyMeter::sample(Time now) {
  if (!is_valid_) return;
  std::optional<double> joules;
  if (!counters_.empty()) {
    std::vector<EnergyCounter> counters = read_rapl(root_);
    joules = joules_between(counters_, counters);
    counters_ = std::move(counters);
  } else {
    joules = *power_w_ * std::chrono::duration<double>(now - last_).count();
    power_w_ = power_w();
    if (!power_w_) joules.reset();
  }
  last_ = now;
  is_valid_ = joules.has_value();
  if (joules) joules_ += *joules;
}

std::optional<EnergyUse> EnergyMeter::so_far() const {
  if (!is_valid_) return std::nullopt;
  return EnergyUse{joules_, source_};
}

std::optional<EnergyUse> EnergyMeter::use(Time now) {
  sample(now);
  return so_far();
}

DeviceScore energy_score(std::span<const EnergySample> samples, double idle_w) {
  DeviceScore score;
  if (samples.size() < 2) return score;
  const double duration = samples.back().t_s - samples.front().t_s;
  if (duration <= 0.0) return score;
  score.energy_rate_hz = static_cast<double>(samples.size() - 1) / duration;
  if (*score.energy_rate_hz < kLowestEnergyRateHz) return score;
  score.idle_w = idle_w;
  score.power_w = (samples.back().joules - samples.front().joules) / duration;
  const auto per_frame = joules_per_frame(samples.front(), samples.back(), idle_w);
  if (!per_frame || *per_frame < 0.0) return score;
  score.joules_per_frame = per_frame;
  score.joules_per_frame_sd = spread(samples, idle_w);
  return score;
}

std::optional<double> idle_power_w(const std::filesystem::path& root,
                                   const std::filesystem::path& tegrastats) {
  const EnergyMeter::Time start = std::chrono::steady_clock::now();
  EnergyMeter meter(root, tegrastats, start);
  if (!meter.so_far()) return std::nullopt;
  EnergyMeter::Time last = start;
  while (last - start < kIdleTime) {
    std::this_thread::sleep_until(last + kSampleInterval);
    last = std::chrono::steady_clock::now();
    meter.sample(last);
  }
  const std::optional<EnergyUse> use = meter.so_far();
  if (!use) return std::nullopt;
  return use->joules / std::chrono::duration<double>(last - start).count();
}

RunMonitor::RunMonitor(std::filesystem::path root) : root_(std::move(root)) {
  if (root_.empty()) return;
  idle_w_ = idle_power_w(root_, {});
  before_ = read_throttle_state(root_);
  if (!idle_w_) return;
  start_ = Clock::now();
  meter_.emplace(root_, "", start_);
  thread_ = std::jthread([this](const std::stop_token& stop) { sample_until_stopped(stop); });
}

bool RunMonitor::wait_until(Clock::time_point time, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  stopped_.wait_until(lock, stop, time, [] { return false; });
  return !stop.stop_requested();
}

void RunMonitor::add_sample(Clock::time_point now) {
  meter_->sample(now);
  const auto use = meter_->so_far();
  is_valid_ = is_valid_ && use.has_value();
  if (!is_valid_) return;
  samples_.push_back({.t_s = std::chrono::duration<double>(now - start_).count(),
                      .joules = use->joules,
                      .frames = frames_.load()});
}

void RunMonitor::sample_until_stopped(const std::stop_token& stop) {
  name_this_thread("energy");
  Clock::time_point next = start_;
  do {
    add_sample(Clock::now());
    throttled_ = throttled_ || throttled_between(before_, read_throttle_state(root_)).value_or(false);
    next += kSampleInterval;
  } while (wait_until(next, stop));
  add_sample(Clock::now());
}

std::optional<DeviceScore> RunMonitor::finish() {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
  if (root_.empty()) return std::nullopt;
  const std::optional<bool> throttled = throttled_between(before_, read_throttle_state(root_));
  if (!idle_w_ && !throttled) return std::nullopt;
  DeviceScore score = idle_w_ && is_valid_ ? energy_score(samples_, *idle_w_) : DeviceScore{};
  if (throttled) score.throttled = throttled_ || *throttled ? 1.0 : 0.0;
  score.temperature_c = hottest_celsius(root_);
  return score;
}

}  // namespace stillpoint::bench
