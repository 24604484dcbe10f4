// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/plan_runner.h"

#include <algorithm>
#include <cstdlib>

#include "bench/plan/child_process.h"
#include "core/base/error.h"
#include "datasets/synthetic/sequence_cache.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr int kFirstSignalCode = 128;
constexpr std::string_view kErrorPrefix = "stillpoint: error: ";

BenchRow failed_row(BenchRow row, const std::string& status, const std::string& reason) {
  row.status = status;
  row.reason = reason;
  return row;
}

std::string reason_of(const ChildResult& child) {
  if (child.exit_code > kFirstSignalCode) {
    return "ended by signal " + std::to_string(child.exit_code - kFirstSignalCode);
  }
  const bool is_error = child.last_message.starts_with(kErrorPrefix);
  return is_error ? child.last_message.substr(kErrorPrefix.size()) : child.last_message;
}

bool stopped(const PlanHooks& hooks) { return hooks.stop_requested && hooks.stop_requested(); }

/// Runs one variant on a sequence folder in a child process.
BenchRow run_one(const fs::path& sequence, const BenchRow& row, const fs::path& out, const PlanHooks& hooks) {
  hooks.on_step("run " + row.sequence + " " + row.variant);
  const fs::path folder = out / row.sequence / folder_name(row.variant);
  fs::remove(folder / "result.json");
  const ChildResult child = run_self(
      {"run", sequence.string(), "--variant", row.variant, "--out", folder.string()}, hooks.stop_requested);
  if (fs::exists(folder / "result.json")) return read_result(folder / "result.json", row);
  return failed_row(row, "failed", reason_of(child));
}

/// Where a sequence lies, or why it takes no part.
struct Located {
  std::string name;
  fs::path folder;
  std::string missing_status;  ///< of its rows, when the folder is empty
  std::string missing_reason;
};

Located locate_rendered(const std::string& name, const RenderedGroup& group, const PlanHooks& hooks) {
  hooks.on_step("render " + name);
  try {
    SynthRequest request = preset_request(name);
    request.seconds = group.seconds;
    request.seed = static_cast<std::uint64_t>(group.seed);
    return {name,
            cached_sequence(request, {.progress = hooks.on_rendered, .stop_requested = hooks.stop_requested}),
            "interrupted", "the rendering was stopped"};
  } catch (const InputError& error) {
    return {name, {}, "failed", error.what()};
  }
}

Located locate_recorded(const std::string& name) {
  const fs::path folder = data_folder() / name;
  if (fs::is_directory(folder)) return {name, folder, "", ""};
  return {name, {}, "skipped", "no folder " + folder.string() + "; set STILLPOINT_DATA to where it is"};
}

}  // namespace

fs::path data_folder() {
  const char* set = std::getenv("STILLPOINT_DATA");
  return set != nullptr ? fs::path(set) : fs::path("../shared/data");
}

std::string folder_name(std::string variant) {
  std::replace(variant.begin(), variant.end(), '/', '-');
  return variant;
}

std::vector<BenchRow> run_plan(const BenchPlan& plan, const fs::path& out, const PlanHooks& hooks) {
  std::vector<BenchRow> rows;
  const auto run_variants = [&](const Located& located, const std::vector<std::string>& variants) {
    for (const std::string& variant : variants) {
      if (stopped(hooks)) return;
      BenchRow row;
      row.sequence = located.name;
      row.variant = variant;
      rows.push_back(located.folder.empty() ? failed_row(row, located.missing_status, located.missing_reason)
                                            : run_one(located.folder, row, out, hooks));
    }
  };
  for (const std::string& name : plan.rendered.sequences) {
    if (stopped(hooks)) return rows;
    run_variants(locate_rendered(name, plan.rendered, hooks), plan.rendered.variants);
  }
  for (const std::string& name : plan.recorded.sequences) {
    run_variants(locate_recorded(name), plan.recorded.variants);
  }
  return rows;
}

}  // namespace stillpoint
