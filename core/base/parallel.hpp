#pragma once
#include <algorithm>
#include <functional>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

/// Number of threads that parallel loops use from now on; 0 (the start value) means all cores. Not
/// thread-safe: the program sets it once, before any work.
void set_thread_count(int threads);
int thread_count();

/// Calls body(begin, end) on consecutive ranges of at most `grain` that cover [0, count), on any thread in
/// any order. The ranges depend on count and grain alone, never on the number of threads. The first exception
/// (by range) is thrown again here after all ranges ended.
void parallel_for(Offset count, Offset grain, const std::function<void(Offset begin, Offset end)>& body);

/// Folds body(begin, end) over the same ranges, joined in their order: the same bits on any number of
/// threads.
template <typename T, typename Body, typename Join>
T parallel_reduce(Offset count, Offset grain, T start, const Body& body, const Join& join) {
  std::vector<T> parts(static_cast<std::size_t>((count + grain - 1) / grain));
  parallel_for(static_cast<Offset>(parts.size()), 1, [&](Offset begin, Offset end) {
    for (Offset part = begin; part < end; ++part) {
      parts[part] = body(part * grain, std::min(count, (part + 1) * grain));
    }
  });
  for (const T& part : parts) start = join(start, part);
  return start;
}

}  // namespace flowcage
