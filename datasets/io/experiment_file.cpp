// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/experiment_file.h"

#include "core/base/error.h"
#include "datasets/io/sensor_yaml.h"

namespace stillpoint::datasets {
namespace {

std::vector<ExperimentSequence> read_sequences(const std::filesystem::path& file) {
  const SensorYaml config(file);
  std::vector<ExperimentSequence> sequences;
  for (const std::string& dataset : config.keys()) {
    for (const std::string& sequence : config.texts(dataset)) sequences.push_back({dataset, sequence});
  }
  if (sequences.empty()) throw InputError(file.string(), "lists no sequence");
  return sequences;
}

Experiment experiment_of(const SensorYaml& file, const std::string& name,
                         const std::filesystem::path& folder) {
  const SensorYaml entry = file.child(name);
  Experiment experiment{.name = name, .system = entry.text("Module"), .runs = entry.positive_int("NumRuns")};
  if (entry.has("Parameters")) {
    const SensorYaml parameters = entry.child("Parameters");
    if (parameters.has("mode")) experiment.mode = parameters.text("mode");
  }
  experiment.sequences = read_sequences(folder / entry.text("Config"));
  return experiment;
}

}  // namespace

std::vector<Experiment> read_experiments(const std::filesystem::path& file) {
  const SensorYaml yaml(file);
  std::vector<Experiment> experiments;
  for (const std::string& name : yaml.keys())
    experiments.push_back(experiment_of(yaml, name, file.parent_path()));
  if (experiments.empty()) throw InputError(file.string(), "has no experiment");
  return experiments;
}

}  // namespace stillpoint::datasets
