#include "core/export/write_ranges.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include "core/base/parallel.hpp"

namespace flowcage {

static_assert(std::endian::native == std::endian::little,
              "the binary writers say that they are little-endian");

void write_ranges(std::span<std::ostream* const> files, Offset count, Offset grain,
                  const std::function<void(Offset, Offset, std::span<std::string>)>& fill) {
  const std::size_t width = files.size();
  const Offset at_once = 2 * thread_count();
  std::vector<std::string> texts(static_cast<std::size_t>(at_once) * width);
  const Offset ranges = (count + grain - 1) / grain;
  for (Offset first = 0; first < ranges; first += at_once) {
    const Offset n = std::min(at_once, ranges - first);
    parallel_for(n, 1, [&](Offset begin, Offset end) {
      for (Offset i = begin; i < end; ++i) {
        const std::span<std::string> own(texts.data() + static_cast<std::size_t>(i) * width, width);
        for (std::string& text : own) text.clear();
        fill((first + i) * grain, std::min(count, (first + i + 1) * grain), own);
      }
    });
    for (Offset i = 0; i < n; ++i) {
      for (std::size_t f = 0; f < width; ++f) {
        const std::string& text = texts[static_cast<std::size_t>(i) * width + f];
        files[f]->write(text.data(), static_cast<std::streamsize>(text.size()));
      }
    }
  }
}

void write_ranges(std::ostream& out, Offset count, Offset grain,
                  const std::function<void(Offset, Offset, std::string&)>& fill) {
  std::ostream* const file = &out;
  write_ranges({&file, 1}, count, grain,
               [&](Offset begin, Offset end, std::span<std::string> texts) { fill(begin, end, texts[0]); });
}

}  // namespace flowcage
