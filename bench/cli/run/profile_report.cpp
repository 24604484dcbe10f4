// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/run/profile_report.h"

#include <algorithm>
#include <charconv>
#include <iostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/resource_metrics.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "eval/statistics/change_points.h"
#include "reports/tables/text_format.h"

namespace stillpoint::bench {
namespace {

using Json = nlohmann::ordered_json;

Json waits_json(const std::vector<ChannelWaits>& waits) {
  Json list = Json::array();
  for (const ChannelWaits& wait : waits) {
    list.push_back({{"channel", wait.channel},
                    {"for_items", {{"waits", wait.for_items.waits}, {"ns", wait.for_items.ns}}},
                    {"for_room", {{"waits", wait.for_room.waits}, {"ns", wait.for_room.ns}}}});
  }
  return list;
}

Json recorder_json(const RecorderCost& cost) {
  return {{"timer_ns", cost.timer_ns},
          {"timers_per_frame", cost.timers_per_frame},
          {"recording_us_per_frame", cost.recording_us_per_frame},
          {"fraction", cost.fraction}};
}

Json counters_json(const std::vector<HardwareCount>& counters) {
  if (counters.empty()) return nullptr;
  Json json;
  for (const HardwareCount& counter : counters) json[counter.name] = counter.count;
  return json;
}

std::string ms(double value) { return fmt::format("{:.3f}", value); }

void print_times(const std::vector<ProfileRow>& rows, const DeadlineMisses& misses) {
  report::TableRows table = {
      {"ms", "per", "mean", "median", "p95", "p99", "max", "calls", "frames over budget"}};
  const auto add = [&](std::string_view name, const char* per, const TimingStatistics& time,
                       std::int64_t over_budget) {
    table.push_back({std::string(name), per, ms(time.mean), ms(time.median), ms(time.p95), ms(time.p99),
                     ms(time.max), fmt::format("{}", time.calls), fmt::format("{}", over_budget)});
  };
  for (const ProfileRow& row : rows) {
    const std::string_view name = module_name(row.module);
    if (!is_thread(row.module) && row.per_call.mean != row.per_frame.mean)
      add(name, "call", row.per_call, row.frames_over);
    add(name, "frame", row.per_frame, row.frames_over);
  }
  if (misses.whole_frame) add("all_stages", "frame", *misses.whole_frame, misses.one_thread);
  std::cout << report::format_table(table, report::TableStyle::kText);
}

void print_waits(const std::vector<ChannelWaits>& waits) {
  for (const ChannelWaits& wait : waits) {
    std::cout << fmt::format("queue \"{}\": {} waits for items, {:.1f} ms; {} waits for space, {:.1f} ms\n",
                             wait.channel, wait.for_items.waits,
                             1e-6 * static_cast<double>(wait.for_items.ns), wait.for_room.waits,
                             1e-6 * static_cast<double>(wait.for_room.ns));
  }
}

void print_process(const Profile& profile) {
  const ProcessUsage& usage = profile.usage;
  std::cout << fmt::format(
      "CPU time {:.2f} s user + {:.2f} s system, {} voluntary and {} involuntary context switches, "
      "{} minor and {} major page faults, peak memory {:.0f} MB\n",
      usage.user_s, usage.system_s, usage.voluntary_switches, usage.involuntary_switches, usage.minor_faults,
      usage.major_faults, 1e-6 * static_cast<double>(usage.peak_memory_bytes));
  for (const auto& [id, thread] : profile.threads) {
    std::cout << fmt::format("  thread {} {}: {:.2f} s user + {:.2f} s system, {:.0f} % of a core\n", id,
                             thread.name, thread.user_s, thread.system_s,
                             100.0 * (thread.user_s + thread.system_s) / profile.run.wall_s);
  }
}

std::string energy_text(const Profile& profile) {
  if (!profile.energy)
    return "n/a: neither RAPL nor a power sensor is readable (on Jetson devices: --tegrastats LOG)";
  std::string whole =
      fmt::format("{:.2f} J, whole machine ({})", profile.energy->joules, profile.energy->source);
  if (!profile.idle_w) return whole;
  const std::optional<double> per_frame = profile.energy_above_idle.joules_per_frame;
  return whole + fmt::format("; above idle ({:.2f} W): ", *profile.idle_w) +
         (per_frame ? fmt::format("{:.4f} J per frame", *per_frame)
                    : fmt::format("n/a: not more than idle, or sampled less than {:g} times per second",
                                  kLowestEnergyRateHz));
}

std::string counters_text(const Profile& profile) {
  if (profile.counters.empty()) return "n/a: " + profile.counters_missing;
  std::string text;
  for (const HardwareCount& counter : profile.counters) {
    text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", counter.name,
                        static_cast<double>(counter.count));
  }
  return text;
}

void print_machine(const Profile& profile) {
  std::cout << "hardware counters: " << counters_text(profile) << '\n';
  std::cout << "energy: " << energy_text(profile) << '\n';
  std::cout << "allocations: "
            << (profile.allocations
                    ? fmt::format("{} per frame (median), {} at most; all threads, including the recorder",
                                  profile.allocations->median, profile.allocations->largest)
                    : "n/a: not counted by this program; use stillpoint_counting")
            << '\n';
  const RecorderCost& recorder = profile.recorder;
  std::cout << fmt::format(
      "recorder: {:.1f} timers per frame ({:.0f} ns each); recording took {:.1f} us per frame; {:.2f} % of "
      "the "
      "stage times\n",
      recorder.timers_per_frame, recorder.timer_ns, recorder.recording_us_per_frame,
      100.0 * recorder.fraction);
}

}  // namespace

double parse_duration_s(std::string_view text, const std::string& option) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  const double unit_s = unit == "s" ? 1.0 : unit == "m" ? 60.0 : unit == "h" ? 3600.0 : 0.0;
  constexpr double kLongestS = 1e6;
  const double seconds = value * unit_s;
  if (error != std::errc{} || !(seconds > 0.0) || seconds > kLongestS)
    throw InputError(option, "\"" + std::string(text) + "\" is not a duration; write 90s, 10m or 1h");
  return seconds;
}

Json drift_json(const std::vector<DriftRow>& rows) {
  Json list = Json::array();
  for (const DriftRow& row : rows) {
    list.push_back({{"t_s", row.t_s},
                    {"frame_ms", row.frame_ms},
                    {"temperature_c", row.temperature_c ? Json(*row.temperature_c) : Json(nullptr)},
                    {"throttled", row.throttled ? Json(*row.throttled) : Json(nullptr)}});
  }
  return list;
}

namespace {

/// The times at both ends of the line through all repetitions, as single repetitions scatter.
std::string time_trend_text(const std::vector<DriftRow>& rows) {
  constexpr double kSignificance = 0.05;
  std::vector<double> frame_ms;
  for (const DriftRow& row : rows) frame_ms.push_back(row.frame_ms);
  const std::optional<eval::Trend> trend = eval::trend_of(frame_ms);
  if (!trend)
    return fmt::format("{:.3f} -> {:.3f} ms per frame, too few repetitions for a trend", frame_ms.front(),
                       frame_ms.back());
  const double last = static_cast<double>(rows.size() - 1);
  return fmt::format("{:.3f} -> {:.3f} ms per frame by the line through all, {} (p = {:.2g})",
                     trend->intercept, trend->intercept + trend->slope * last,
                     trend->p_value <= kSignificance ? "a trend" : "no significant trend", trend->p_value);
}

}  // namespace

std::string drift_text(const std::vector<DriftRow>& rows) {
  if (rows.empty()) return "";
  const DriftRow& first = rows.front();
  const DriftRow& last = rows.back();
  const auto celsius = [](const DriftRow& row) {
    return row.temperature_c ? fmt::format("{:.1f} deg C", *row.temperature_c) : "n/a";
  };
  const auto throttled = std::ranges::count(rows, std::optional(true), &DriftRow::throttled);
  const bool is_known =
      std::ranges::any_of(rows, [](const DriftRow& row) { return row.throttled.has_value(); });
  return fmt::format("drift over {} in {:.0f} s: {}; temperature {} -> {}, throttled in {}\n",
                     counted(rows.size(), "repetition"), last.t_s, time_trend_text(rows), celsius(first),
                     celsius(last), is_known ? fmt::format("{}", throttled) : "n/a");
}

std::string profile_text(const Profile& profile, const ProfileTitle& title) {
  Json json = {{"schema", 1},
               {"sequence", title.sequence},
               {"base", title.base},
               {"variant", title.variant},
               {"mode", title.mode},
               {"cores", title.cores},
               {"wall_s", profile.run.wall_s}};
  json.update(profile_json(profile.rows, profile.misses));
  json["waits"] = waits_json(profile.run.summary.waits);
  json["process"] = usage_json(profile.usage, profile.threads);
  json["counters"] = counters_json(profile.counters);
  const auto or_null = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  json["energy_j"] = profile.energy ? Json(profile.energy->joules) : Json(nullptr);
  json["other_load"] = or_null(profile.other_load);
  json["idle_power_w"] = or_null(profile.idle_w);
  json["energy_j_per_frame"] = or_null(profile.energy_above_idle.joules_per_frame);
  json["energy_j_per_frame_sd"] = or_null(profile.energy_above_idle.joules_per_frame_sd);
  json["allocations_per_frame"] = profile.allocations ? Json{{"median", profile.allocations->median},
                                                             {"largest", profile.allocations->largest}}
                                                      : Json(nullptr);
  json["recorder"] = recorder_json(profile.recorder);
  if (!profile.drift.empty()) json["drift"] = drift_json(profile.drift);
  return json.dump(2);
}

void print_profile(const Profile& profile) {
  if (profile.other_load.value_or(0.0) >= kMaxQuietLoad) {
    std::cout << fmt::format(
        "the machine was not idle: other processes used {:.0f} % of the CPU; these times are larger than "
        "those of an idle machine\n",
        100.0 * *profile.other_load);
  }
  print_times(profile.rows, profile.misses);
  std::cout << fmt::format(
      "{} frames in {:.2f} s; over {:g} ms: {} on one thread, {} with one thread per stage\n",
      profile.misses.frames, profile.run.wall_s, profile.misses.budget_ms, profile.misses.one_thread,
      profile.misses.thread_per_stage);
  if (const auto& report = profile.run.summary.realtime) {
    std::cout << fmt::format(
        "real time: {} dropped, {} with late detections, {} later than {:.1f} ms\n",
        counted(static_cast<std::size_t>(report->dropped), "frame"), report->late_detections,
        counted(static_cast<std::size_t>(report->deadline_misses()), "pose"), report->deadline_ms);
  }
  print_waits(profile.run.summary.waits);
  print_process(profile);
  print_machine(profile);
}

}  // namespace stillpoint::bench
