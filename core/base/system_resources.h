// SPDX-License-Identifier: BSD-3-Clause
/// Failures because a limit of the system is reached, which are no faults of a file.
#pragma once

#include <cerrno>
#include <string>
#include <system_error>

namespace stillpoint {

/// @param error value of errno after a call that failed
/// @param place the file that could not be opened
/// @throws std::system_error if `error` is a limit of open files or of memory
inline void require_resources(int error, const std::string& place) {
  if (error == EMFILE || error == ENFILE || error == ENOMEM)
    throw std::system_error(error, std::generic_category(), place);
}

}  // namespace stillpoint
