// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/thread_pool.h"

#include <utility>

namespace stillpoint {

ThreadPool::ThreadPool(int threads) {
  for (int i = 1; i < threads; ++i) workers_.emplace_back([this] { run_worker(); });
}

ThreadPool::~ThreadPool() {
  const std::lock_guard lock(mutex_);
  stopping_ = true;
  job_posted_.notify_all();
}

void ThreadPool::for_each_index(std::size_t count, const std::function<void(std::size_t)>& task) {
  {
    const std::lock_guard lock(mutex_);
    task_ = &task;
    count_ = count;
    next_ = 0;
    busy_ = workers_.size();
    failure_ = nullptr;
    ++generation_;
  }
  job_posted_.notify_all();
  run_tasks();
  std::unique_lock lock(mutex_);
  workers_idle_.wait(lock, [this] { return busy_ == 0; });
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void ThreadPool::run_worker() {
  std::size_t finished_generation = 0;
  std::unique_lock lock(mutex_);
  while (true) {
    job_posted_.wait(lock, [&] { return stopping_ || generation_ != finished_generation; });
    if (stopping_) return;
    finished_generation = generation_;
    lock.unlock();
    run_tasks();
    lock.lock();
    if (--busy_ == 0) workers_idle_.notify_one();
  }
}

void ThreadPool::run_tasks() {
  for (std::size_t i = next_++; i < count_; i = next_++) {
    try {
      (*task_)(i);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
  }
}

}  // namespace stillpoint
