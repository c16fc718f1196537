#pragma once
#include <array>
#include <charconv>
#include <functional>
#include <ostream>
#include <span>
#include <string>
#include <type_traits>

#include "core/base/types.hpp"

namespace flowcage {

/// Writes what fill(begin, end, text) appends for consecutive ranges of at most `grain` of [0, count), in
/// their order. Ranges are filled in parallel; the bytes depend neither on the number of threads nor on
/// `grain`.
void write_ranges(std::ostream& out, Offset count, Offset grain,
                  const std::function<void(Offset begin, Offset end, std::string& text)>& fill);

/// The same for several files that are made of the same ranges: text n is for file n. Every range is visited
/// once.
void write_ranges(std::span<std::ostream* const> files, Offset count, Offset grain,
                  const std::function<void(Offset begin, Offset end, std::span<std::string> texts)>& fill);

/// Appends a number: the shortest text that reads back as the same bits.
template <typename Number>
void append_number(std::string& text, Number value) {
  std::array<char, 32> digits;
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), result.ptr);
}

/// Appends the bytes of a value as this machine, which is little-endian, stores it.
template <typename Value>
void append_raw(std::string& text, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  text.append(reinterpret_cast<const char*>(&value), sizeof(Value));
}

}  // namespace flowcage
