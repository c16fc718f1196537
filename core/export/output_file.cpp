#include "core/export/output_file.hpp"

#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <system_error>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"

namespace flowcage {

static_assert(std::endian::native == std::endian::little,
              "the binary writers say that they are little-endian");

OutputFile::OutputFile(const std::filesystem::path& path) : path_(path) {
  errno = 0;
  stream_.open(path, std::ios::binary | std::ios::trunc);
  if (!stream_) fail();
}

void OutputFile::write(std::string_view text) {
  errno = 0;
  stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream_) fail();
}

void OutputFile::close() {
  errno = 0;
  stream_.close();
  if (!stream_) fail();
}

void OutputFile::write_ranges(Offset count, Offset grain,
                              const std::function<void(Offset, Offset, std::string&)>& fill) {
  std::vector<std::string> texts(static_cast<std::size_t>(2 * thread_count()));
  const Offset ranges = (count + grain - 1) / grain;
  for (Offset first = 0; first < ranges; first += static_cast<Offset>(texts.size())) {
    const Offset n = std::min<Offset>(static_cast<Offset>(texts.size()), ranges - first);
    parallel_for(n, 1, [&](Offset begin, Offset end) {
      for (Offset i = begin; i < end; ++i) {
        texts[i].clear();
        fill((first + i) * grain, std::min(count, (first + i + 1) * grain), texts[i]);
      }
    });
    for (Offset i = 0; i < n; ++i) write(texts[i]);
  }
}

void OutputFile::fail() const {
  const std::string reason = errno != 0 ? std::generic_category().message(errno) : "unknown reason";
  throw Error(ErrorKind::output, fmt::format("{}: cannot write: {}", path_.string(), reason),
              "check that the folder exists, may be written, and that the disk is not full");
}

}  // namespace flowcage
