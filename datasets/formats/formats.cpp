// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/formats/formats.h"

#include <array>

namespace stillpoint::datasets {

std::span<const SequenceFormat* const> sequence_formats() {
  static constexpr std::array<const SequenceFormat*, 5> kAll{&kTumFormat, &kOpenLorisFormat, &kEurocFormat,
                                                             &kSevenScenesFormat, &kFolderFormat};
  return kAll;
}

}  // namespace stillpoint::datasets
