// SPDX-License-Identifier: BSD-3-Clause
/// The number of threads of OpenCV: one setting for all modules of a process.
#pragma once

#include <opencv2/core/utility.hpp>

namespace stillpoint {

/// Number of OpenCV threads within a scope; the previous number is restored at its end. A change while
/// another thread executes a function of OpenCV would change the threads, and the time, of that function: the
/// runners therefore hold one scope with `detector.threads` for a whole run, so that the one of the network
/// in it changes nothing.
class ScopedOpencvThreads {
 public:
  /// @param threads >= 1
  explicit ScopedOpencvThreads(int threads) : previous_(cv::getNumThreads()) {
    if (threads != previous_) cv::setNumThreads(threads);
  }
  ~ScopedOpencvThreads() {
    if (cv::getNumThreads() != previous_) cv::setNumThreads(previous_);
  }
  ScopedOpencvThreads(const ScopedOpencvThreads&) = delete;
  ScopedOpencvThreads& operator=(const ScopedOpencvThreads&) = delete;

 private:
  int previous_;
};

}  // namespace stillpoint
