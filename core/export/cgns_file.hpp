#pragma once
#include <cgnslib.h>

#include <filesystem>
#include <string>

#include "core/base/error.hpp"
#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// A CGNS file that is open; closed with the object. Every failure of the library is an Error of the kind of
/// its use (input for reading, output for writing) with the library's reason. One at a time: the library
/// keeps its state in globals.
class CgnsFile {
 public:
  enum class Use { read, write };
  /// Opens a file, or creates one of type HDF5; messages call it `shown_as`.
  CgnsFile(const std::filesystem::path& file, Use use, std::string shown_as);
  ~CgnsFile();
  CgnsFile(const CgnsFile&) = delete;
  CgnsFile& operator=(const CgnsFile&) = delete;

  int number() const { return number_; }
  /// Throws if a call of the library did not return CG_OK.
  void check(int status) const;
  /// Closes; what cannot be written shows here. Nothing may be done afterwards.
  void close();
  [[noreturn]] void fail(const std::string& what, const std::string& remedy) const;

 private:
  std::string shown_as_;
  Use use_;
  int number_ = -1;
};

/// The condition of CGNS for a type of patch, and back (walls for all that have no type of their own).
BCType_t cgns_condition(PatchType type);
PatchType patch_type_of(BCType_t condition);

}  // namespace flowcage
