#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace flowcage {

/// A VTK XML file taken apart: its elements, and the numbers of its data arrays on demand. Every function
/// throws Error(input) with file and line.
class VtkXmlFile {
 public:
  struct Element {
    std::string name, parent;
    std::map<std::string, std::string> attributes;
    std::size_t position = 0;                  ///< of the tag
    std::size_t text_begin = 0, text_end = 0;  ///< the first text of its own that is not blank

    std::string attribute(const std::string& key) const {
      const auto it = attributes.find(key);
      return it == attributes.end() ? std::string() : it->second;
    }
  };

  /// Reads a file; refuses what is no VTKFile of that type ("UnstructuredGrid") or cannot be decoded here
  /// (big-endian, compressors other than zlib).
  VtkXmlFile(const std::string& file, const std::string& type);

  /// In the file's order; AppendedData is the last, and not taken apart.
  const std::vector<Element>& elements() const { return elements_; }

  /// The numbers of a DataArray.
  std::vector<double> read_reals(const Element& array) const;
  /// The same as whole numbers; refuses reals.
  std::vector<std::int64_t> read_integers(const Element& array) const;

  [[noreturn]] void fail(const Element& element, const std::string& what, const std::string& remedy) const;

 private:
  void parse_elements();
  Element parse_tag(std::size_t& at, bool& closed) const;
  void check_encoding(const std::string& type);
  std::string decode(const Element& array) const;
  std::string decompress(const Element& array, std::string_view stored, bool base64) const;
  template <typename Number>
  std::vector<Number> read(const Element& array) const;

  std::string name_, text_;
  std::vector<Element> elements_;
  std::size_t header_bytes_ = 4;
  bool compressed_ = false;
};

}  // namespace flowcage
