// SPDX-License-Identifier: BSD-3-Clause
/// Thread pool of the grid detector. Paper Sec. III-B.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace stillpoint {

class ThreadPool {
 public:
  /// @param threads number of threads including the calling one, >= 1; with 1 no thread is started
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// Calls task(0) ... task(count - 1), each once, in any order and on any thread; returns when all are done.
  /// The result does not depend on the scheduling if the calls write to disjoint memory. Rethrows the first
  /// exception of a task. Must not be called concurrently or from within a task.
  void for_each_index(std::size_t count, const std::function<void(std::size_t)>& task);

 private:
  void run_worker();
  void run_tasks();

  std::mutex mutex_;
  std::condition_variable job_posted_;
  std::condition_variable workers_idle_;
  const std::function<void(std::size_t)>* task_ = nullptr;
  std::size_t count_ = 0;
  std::atomic<std::size_t> next_{0};
  std::size_t busy_ = 0;        // workers that have not finished the current job
  std::size_t generation_ = 0;  // jobs posted so far
  bool stopping_ = false;
  std::exception_ptr failure_;
  std::vector<std::jthread> workers_;  // last: joined before the rest is destroyed
};

}  // namespace stillpoint
