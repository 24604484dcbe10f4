// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/charts/fault_bands.h"

#include <nlohmann/json.hpp>

#include "datasets/faults/faulty_stream.h"
#include "datasets/faults/sensor_fault.h"

namespace stillpoint::report {

std::vector<FaultBand> fault_bands(const std::string& manifest, Timestamp first, Timestamp last) {
  std::vector<FaultBand> bands;
  const nlohmann::json json = nlohmann::json::parse(manifest, nullptr, false);
  if (!json.is_object()) return bands;
  for (const std::string& text : json.value("faults", std::vector<std::string>())) {
    for (const datasets::FaultInterval& interval :
         datasets::fault_intervals(datasets::parse_fault(text), first, last)) {
      bands.push_back({seconds_between(first, interval.begin), seconds_between(first, interval.end), text});
    }
  }
  return bands;
}

}  // namespace stillpoint::report
