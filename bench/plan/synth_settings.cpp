// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/synth_settings.h"

#include <cmath>
#include <type_traits>
#include <vector>

#include "bench/config/spelling.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

constexpr double kMaxMagnitude = 1e9;  // far above any sensible value; fits in an int

/// Visits all fields and sets the one with the given key; collects all keys for the error message.
class NumberSetter {
 public:
  NumberSetter(std::string key, double value) : key_(std::move(key)), value_(value) {}

  template <class Field>
  void operator()(const std::string& name, Field&& field) {
    using Value = std::remove_cvref_t<Field>;
    if constexpr (std::is_same_v<Value, double> || std::is_same_v<Value, int>) {
      visit_number(prefix_ + name, field);
    } else if constexpr (std::is_class_v<Value> && !std::is_same_v<Value, std::string>) {
      const std::string outer = prefix_;
      prefix_ += name + ".";
      visit_fields(*this, field);
      prefix_ = outer;
    }
  }

  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] const std::vector<std::string>& known() const { return known_; }

 private:
  template <class Number>
  void visit_number(const std::string& key, Number& number) {
    known_.push_back(key);
    if (key != key_) return;
    found_ = true;
    if (std::is_same_v<Number, int> && value_ != std::floor(value_)) {
      throw InputError("synth." + key_, "must be an integer");
    }
    number = static_cast<Number>(value_);
  }

  std::string key_;
  double value_;
  std::string prefix_;
  std::vector<std::string> known_;
  bool found_ = false;
};

}  // namespace

synth::SynthRequest with_number(synth::SynthRequest request, const std::string& key, double value) {
  if (!(std::abs(value) <= kMaxMagnitude))
    throw InputError("synth." + key, "must be a finite number below 1e9");
  NumberSetter setter(key, value);
  visit_fields(setter, request);
  if (!setter.found()) {
    throw InputError("unknown rendering parameter \"synth." + key + "\"" + suggestion(key, setter.known()));
  }
  synth::check_request(request);
  return request;
}

}  // namespace stillpoint::bench
