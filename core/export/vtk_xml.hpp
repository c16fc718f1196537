#pragma once
#include <functional>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "core/export/write_ranges.hpp"

namespace flowcage {

/// The data arrays of a VTK XML file whose numbers follow the XML as raw bytes ("appended", little-endian,
/// 64-bit sizes): sizes are known before the data, so the data is streamed.
class AppendedArrays {
 public:
  /// Appends the bytes of the tuples [begin, end).
  using Fill = std::function<void(Offset begin, Offset end, std::string& bytes)>;

  /// A part of an array, `tuples` tuples of `tuple_bytes` bytes.
  struct Part {
    Offset tuples = 0;
    Offset tuple_bytes = 0;
    Fill fill;
  };

  /// The XML of one array; its data will be the parts one after the other.
  std::string declare(const std::string& type, const std::string& name, int components,
                      std::vector<Part> parts);

  /// The AppendedData element with the data of all arrays, in the order of their declaration.
  void write(std::ostream& out) const;

 private:
  static constexpr Offset header_bytes = 8;
  std::vector<std::vector<Part>> arrays_;
  Offset next_ = 0;
};

/// The values as they are in memory.
template <typename Value>
AppendedArrays::Part array_part(std::span<const Value> values) {
  return {static_cast<Offset>(values.size()), sizeof(Value),
          [values](Offset begin, Offset end, std::string& bytes) {
            bytes.append(reinterpret_cast<const char*>(values.data() + begin),
                         static_cast<std::size_t>(end - begin) * sizeof(Value));
          }};
}

/// `count` values, value(i) as type Value.
template <typename Value, typename Function>
AppendedArrays::Part computed_part(Offset count, Function value) {
  return {count, sizeof(Value), [value](Offset begin, Offset end, std::string& bytes) {
            for (Offset i = begin; i < end; ++i) append_raw(bytes, static_cast<Value>(value(i)));
          }};
}

/// A name inside an XML attribute.
std::string xml_escaped(const std::string& text);

/// `<VTKFile type="TYPE" ...>` as AppendedArrays needs it.
std::string vtk_file_header(const std::string& type, const std::string& version = "1.0");

/// FieldData of a mesh or surface: per patch an array `patch:NAME` that holds its id (the position in
/// `names`), and `patchTypes` if given.
std::string patch_field_data(const std::vector<std::string>& names, const std::vector<int>& types);

}  // namespace flowcage
