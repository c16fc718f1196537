#include "core/base/parallel.hpp"

#include <atomic>
#include <cmath>
#include <stdexcept>

#include "tests/catch.hpp"

using namespace flowcage;

TEST_CASE("parallel_for visits each index once") {
  for (int threads : {1, 2, 8}) {
    set_thread_count(threads);
    std::vector<std::atomic<int>> visits(1003);
    parallel_for(1003, 10, [&](Offset begin, Offset end) {
      for (Offset i = begin; i < end; ++i) ++visits[i];
    });
    for (const auto& v : visits) REQUIRE(v == 1);
  }
  set_thread_count(0);
}

TEST_CASE("parallel_reduce gives the same bits on any number of threads") {
  const auto sum = [](int threads) {
    set_thread_count(threads);
    return parallel_reduce(
        100000, 64, 0.0,
        [](Offset begin, Offset end) {
          double s = 0;
          for (Offset i = begin; i < end; ++i) s += std::sin(static_cast<double>(i)) * 1e-3;
          return s;
        },
        [](double a, double b) { return a + b; });
  };
  const double one = sum(1);
  CHECK(one == sum(2));
  CHECK(one == sum(8));
  set_thread_count(0);
}

TEST_CASE("parallel_for throws the first range's exception") {
  set_thread_count(4);
  CHECK_THROWS_WITH(parallel_for(100, 10,
                                 [](Offset begin, Offset) {
                                   if (begin >= 30) throw std::runtime_error(std::to_string(begin));
                                 }),
                    "30");
  set_thread_count(0);
}
