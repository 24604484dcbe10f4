// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/allocation_counter.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>

namespace {

struct ThreadCount {
  std::atomic<pid_t> thread{0};
  std::atomic<std::size_t> count{0};
};

std::atomic<std::size_t> count{0};
std::array<ThreadCount, 64> thread_counts;
std::atomic<std::size_t> threads{0};
thread_local ThreadCount* this_thread = nullptr;

void count_allocation() {
  ++count;
  if (this_thread == nullptr) {
    this_thread = &thread_counts[std::min(threads++, thread_counts.size() - 1)];
    this_thread->thread = gettid();
  }
  ++this_thread->count;
}

/// Without allocations. @return whether a running thread has this name
bool has_name(pid_t thread, std::string_view name) {
  std::array<char, 64> path{};
  std::snprintf(path.data(), path.size(), "/proc/self/task/%d/comm", thread);
  const int file = open(path.data(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  std::array<char, 32> text{};
  const ssize_t size = read(file, text.data(), text.size());
  close(file);
  return size > 0 && std::string_view(text.data(), static_cast<std::size_t>(size) - 1) == name;
}

}  // namespace

// The linker option --wrap redirects calls of f to __wrap_f; __real_f is the original. Eigen allocates with
// malloc, the standard containers with operator new.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t number, std::size_t size);
void* __real_realloc(void* old, std::size_t size);
void* __wrap_malloc(std::size_t size);
void* __wrap_calloc(std::size_t number, std::size_t size);
void* __wrap_realloc(void* old, std::size_t size);

void* __wrap_malloc(std::size_t size) {
  count_allocation();
  return __real_malloc(size);
}
void* __wrap_calloc(std::size_t number, std::size_t size) {
  count_allocation();
  return __real_calloc(number, size);
}
void* __wrap_realloc(void* old, std::size_t size) {
  count_allocation();
  return __real_realloc(old, size);
}
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

void* operator new(std::size_t size) {
  count_allocation();
  void* const block = __real_malloc(size > 0 ? size : 1);
  if (block == nullptr) throw std::bad_alloc();
  return block;
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  count_allocation();
  return __real_malloc(size > 0 ? size : 1);
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }

namespace stillpoint::bench {

std::size_t allocation_count() { return count; }

std::size_t allocation_count_of(std::string_view thread_name) {
  std::size_t sum = 0;
  for (const ThreadCount& thread : thread_counts) {
    if (thread.thread != 0 && has_name(thread.thread, thread_name)) sum += thread.count;
  }
  return sum;
}

}  // namespace stillpoint::bench
