#include "core/base/parallel.hpp"

#include <atomic>
#include <exception>
#include <memory>
#include <thread>

#ifdef FLOWCAGE_USE_TBB
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#endif

namespace flowcage {
namespace {

// The one piece of state in core that outlives a call: how many threads the process may use.
std::atomic<int> requested_threads{0};
#ifdef FLOWCAGE_USE_TBB
std::unique_ptr<tbb::global_control> thread_limit;  // TBB's own limit, which is the number of cores otherwise
#endif

}  // namespace

void set_thread_count(int threads) {
  requested_threads = std::max(0, threads);
#ifdef FLOWCAGE_USE_TBB
  thread_limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                       static_cast<std::size_t>(thread_count()));
#endif
}

int thread_count() {
  // Asking the system opens a file each time, which small loops would feel.
  static const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const int requested = requested_threads;
  return requested > 0 ? requested : cores;
}

void parallel_for(Offset count, Offset grain, const std::function<void(Offset, Offset)>& body) {
  if (count <= 0) return;
  const Offset parts = (count + grain - 1) / grain;
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(parts));
  const auto run = [&](Offset part) {
    try {
      body(part * grain, std::min(count, (part + 1) * grain));
    } catch (...) {
      failures[part] = std::current_exception();
    }
  };
  const int threads = static_cast<int>(std::min<Offset>(thread_count(), parts));
  if (threads == 1) {
    for (Offset part = 0; part < parts; ++part) run(part);
  } else {
#ifdef FLOWCAGE_USE_TBB
    tbb::parallel_for(tbb::blocked_range<Offset>(0, parts, 1), [&](const tbb::blocked_range<Offset>& range) {
      for (Offset part = range.begin(); part < range.end(); ++part) run(part);
    });
#else
    std::atomic<Offset> next{0};
    const auto worker = [&] {
      for (Offset part = next++; part < parts; part = next++) run(part);
    };
    std::vector<std::thread> pool;
    for (int t = 1; t < threads; ++t) pool.emplace_back(worker);
    worker();
    for (std::thread& thread : pool) thread.join();
#endif
  }
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace flowcage
