// SPDX-License-Identifier: BSD-3-Clause
/// Executes a described system on a sequence: exports the sequence, writes the calibration, starts the
/// program, and reads its trajectory as poses of the camera in the world.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "bench/systems/external_system.h"
#include "bench/systems/slam_system.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::bench {

/// The sequence of a run: from its start on, and with its fault, as the system gets it and as the run is
/// scored.
/// @throws InputError if it cannot be opened, or the fault concerns what it does not have
[[nodiscard]] std::unique_ptr<datasets::SensorStream> played_sequence(const RunRequest& request);

/// Whether a fault changes what an exported sequence contains. The arrival of frames and recorded boxes do
/// not reach another program.
[[nodiscard]] bool reaches_external_systems(const std::string& fault);

/// A message of a program as one line of UTF-8: control characters become blanks, bytes of other encodings
/// `\xNN`.
[[nodiscard]] std::string one_line(std::string text);

/// A trajectory as T_w_c, and how it was read.
struct SystemTrajectory {
  Trajectory trajectory;
  std::string text;  ///< TUM, for the store
  std::string log;   ///< repairs of rows, one line each
};

/// Reads the output of a system, and applies its conventions, but for an unknown scale.
/// @param work output folder of the run; the stamps of a KITTI file are written there
/// @param info of the sequence as it was played
/// @throws InputError if the file is malformed
[[nodiscard]] SystemTrajectory read_output(const ExternalSystem& system, const std::filesystem::path& work,
                                           const datasets::SequenceInfo& info);

/// What a trajectory tells about the frames: those at the stamp of a pose (within 1 ms) are located, those
/// after the first of them without a pose are lost.
/// @param frames times in ascending order
[[nodiscard]] std::vector<eval::ClaimedPose> claims_of(const Trajectory& trajectory,
                                                       std::span<const Timestamp> frames);

/// Runs an external system on a sequence.
class ExternalRun : public SlamSystem {
 public:
  explicit ExternalRun(ExternalSystem system) : system_(std::move(system)) {}

  /// Command line of the system. Exports the sequence first if the system requires another layout; exports
  /// are cached.
  [[nodiscard]] ProcessSpec command(const RunRequest& request) const override;

  [[nodiscard]] bool is_contained() const override { return system_.runner != ContainerRunner::kNone; }

  /// Version, description, sequence and machine.
  [[nodiscard]] std::string manifest(const RunRequest& request) const override;

  /// Evaluates the trajectory written by the system.
  [[nodiscard]] RunOutcome outcome(const RunRequest& request, const ProcessResult& process) const override;

 private:
  ExternalSystem system_;
};

}  // namespace stillpoint::bench
