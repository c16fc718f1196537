#pragma once
#include <charconv>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

/// A file being written; every failure is Error(output) with the file's name and the system's reason. A file
/// counts as written only after close().
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& path);
  void write(std::string_view text);
  void close();

  /// Writes what fill(begin, end, text) appends for consecutive ranges of [0, count), in their order. Ranges
  /// are filled in parallel; the bytes depend neither on the number of threads nor on `grain`.
  void write_ranges(Offset count, Offset grain,
                    const std::function<void(Offset begin, Offset end, std::string& text)>& fill);

 private:
  [[noreturn]] void fail() const;
  std::filesystem::path path_;
  std::ofstream stream_;
};

/// Appends a number: the shortest text that reads back as the same bits.
template <typename Number>
void append_number(std::string& text, Number value) {
  std::array<char, 32> digits;
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), result.ptr);
}

/// Appends the bytes of a number or plain array as this machine stores them (little-endian; see
/// static_assert).
template <typename Value>
void append_raw(std::string& text, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  text.append(reinterpret_cast<const char*>(&value), sizeof(Value));
}

}  // namespace flowcage
