// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/request_text.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "core/base/error.h"

namespace stillpoint::synth {
namespace {

/// Collects `name = value` lines; descends into nested structs with their `visit_fields`.
class TextCollector {
 public:
  void operator()(const std::string& name, bool value) { add(name, value ? "true" : "false"); }
  void operator()(const std::string& name, int value) { add(name, fmt::format("{}", value)); }
  void operator()(const std::string& name, std::uint64_t value) { add(name, fmt::format("{}", value)); }
  void operator()(const std::string& name, double value) { add(name, fmt::format("{:.17g}", value)); }
  void operator()(const std::string& name, const std::string& value) {
    add(name, fmt::format("\"{}\"", value));
  }
  void operator()(const std::string& name, SequenceLayout value) {
    for (const auto& [layout, spelling] : enum_names(SequenceLayout{})) {
      if (layout == value) add(name, fmt::format("\"{}\"", spelling));
    }
  }
  template <class Group>
  void operator()(const std::string& name, const Group& group) {
    const std::string outer = prefix_;
    prefix_ += name + ".";
    visit_fields(*this, group);
    prefix_ = outer;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void add(const std::string& name, const std::string& value) {
    text_ += prefix_ + name + " = " + value + "\n";
  }
  std::string prefix_;
  std::string text_;
};

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw InputError(file.string(),
                     "cannot be read; correct the path, or set STILLPOINT_DATA (preset home_tour)");
  return {std::istreambuf_iterator<char>(in), {}};
}

std::uint64_t fnv1a(const std::string& text, std::uint64_t hash) {
  for (const char character : text) {
    hash = (hash ^ static_cast<std::uint8_t>(character)) * 0x100000001b3ULL;
  }
  return hash;
}

}  // namespace

std::string request_text(const SynthRequest& request) {
  TextCollector collector;
  visit_fields(collector, request);
  return fmt::format("renderer_version = {}\n", kRendererVersion) + collector.text();
}

std::string request_key(const SynthRequest& request) {
  SynthRequest nameless = request;  // the key depends on the contents of the files, not on their paths
  nameless.trajectory_file.clear();
  nameless.imu_file.clear();
  nameless.times_file.clear();
  std::uint64_t hash = fnv1a(request_text(nameless), 0xcbf29ce484222325ULL);
  for (const std::filesystem::path& file : {request.trajectory_file, request.imu_file, request.times_file}) {
    if (!file.empty()) hash = fnv1a(contents(file), hash);
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace stillpoint::synth
