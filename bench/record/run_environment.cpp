// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/run_environment.h"

#include <sys/utsname.h>

#include <fstream>
#include <thread>

#include <nlohmann/json.hpp>

namespace stillpoint::bench {
namespace {

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string kernel_release() {
  utsname names{};
  return uname(&names) == 0 ? std::string(names.sysname) + " " + names.release : "unknown";
}

}  // namespace

HostInfo host_info(const std::filesystem::path& root) {
  DeviceInfo device = device_info(root);
  return {.cpu = cpu_model(),
          .logical_cpus = std::thread::hardware_concurrency(),
          .kernel = kernel_release(),
          .governor = device.governor,
          .device = device};
}

nlohmann::ordered_json host_json(const HostInfo& host) {
  nlohmann::ordered_json json = {
      {"cpu", host.cpu}, {"logical_cpus", host.logical_cpus}, {"kernel", host.kernel}};
  json["governor"] = host.governor ? nlohmann::ordered_json(*host.governor) : nlohmann::ordered_json(nullptr);
  json["device"] = device_json(host.device);
  return json;
}

}  // namespace stillpoint::bench
