#include "core/export/write_ranges.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include "core/base/parallel.hpp"

namespace flowcage {

static_assert(std::endian::native == std::endian::little,
              "the binary writers say that they are little-endian");

void write_ranges(std::ostream& out, Offset count, Offset grain,
                  const std::function<void(Offset, Offset, std::string&)>& fill) {
  std::vector<std::string> texts(static_cast<std::size_t>(2 * thread_count()));
  const auto at_once = static_cast<Offset>(texts.size());
  const Offset ranges = (count + grain - 1) / grain;
  for (Offset first = 0; first < ranges; first += at_once) {
    const Offset n = std::min(at_once, ranges - first);
    parallel_for(n, 1, [&](Offset begin, Offset end) {
      for (Offset i = begin; i < end; ++i) {
        texts[i].clear();
        fill((first + i) * grain, std::min(count, (first + i + 1) * grain), texts[i]);
      }
    });
    for (Offset i = 0; i < n; ++i) {
      out.write(texts[i].data(), static_cast<std::streamsize>(texts[i].size()));
    }
  }
}

}  // namespace flowcage
