#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace flowcage {

/// One file of an OpenFOAM polyMesh, read front to back. Every function throws Error(input) with file and
/// place.
class FoamFile {
 public:
  /// Reads the file and its FoamFile header.
  explicit FoamFile(const std::filesystem::path& file);

  /// A value of the header ("class", "format"); empty if absent.
  std::string header(const std::string& key) const;

  /// The next list, ASCII or binary as the header says: `N ( ... )` or the uniform `N { value }`.
  std::vector<Index> read_labels();
  std::vector<Vec3> read_points();
  /// All faces, as faceCompactList (two lists) or faceList. Refuses a face that has not four points.
  std::vector<std::array<Index, 4>> read_quads();

  /// The entries of a boundary file: a name and its dictionary (only plain values), in order.
  struct Entry {
    std::string name;
    std::map<std::string, std::string> values;
    std::size_t position = 0;
  };
  std::vector<Entry> read_entries();

  [[noreturn]] void fail(std::size_t position, const std::string& what, const std::string& remedy) const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  void skip_space();
  bool accept(char c);
  void expect(char c);
  std::string read_word();
  Offset read_integer();
  double read_real();
  /// A list's length, held against the bytes left when an item takes at least `item_bytes`.
  std::size_t read_length(std::size_t item_bytes);
  const char* read_raw(std::size_t bytes);
  Index raw_label(const char* bytes) const;
  void skip_value(std::string* plain);
  void read_labels_into(std::vector<Index>& labels);

  std::string name_, text_;
  std::size_t at_ = 0;
  std::map<std::string, std::string> header_;
  bool binary_ = false;
  std::size_t label_bytes_ = 4, scalar_bytes_ = 8;
};

}  // namespace flowcage
