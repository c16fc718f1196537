#include "core/export/cgns_file.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <utility>

namespace flowcage {
namespace {

/// HDF5, which stores CGNS files, closes what is open when the process ends; where a full disk refused to
/// take a file's data, it crashes there. Files are closed by CgnsFile, so that the library is asked to leave
/// it. Found by name, because CGNS's package does not come with HDF5's headers; must precede HDF5's first
/// use.
void keep_hdf5_from_exit() {
  static const bool done = [] {
    if (auto* const dont_atexit = reinterpret_cast<int (*)()>(::dlsym(RTLD_DEFAULT, "H5dont_atexit"))) {
      dont_atexit();
    }
    return true;
  }();
  static_cast<void>(done);
}

}  // namespace

CgnsFile::CgnsFile(const std::filesystem::path& file, Use use, std::string shown_as)
    : shown_as_(std::move(shown_as)), use_(use) {
  keep_hdf5_from_exit();
  if (use == Use::write) check(cg_set_file_type(CG_FILE_HDF5));
  check(cg_open(file.c_str(), use == Use::write ? CG_MODE_WRITE : CG_MODE_READ, &number_));
}

CgnsFile::~CgnsFile() {
  if (number_ >= 0) cg_close(number_);
}

void CgnsFile::check(int status) const {
  if (status == CG_OK) return;
  fail(fmt::format("CGNS: {}", cg_get_error()),
       use_ == Use::read ? "the file is damaged or no CGNS file: check it with cgnscheck"
                         : "check that there is space on the disk");
}

void CgnsFile::close() {
  check(cg_close(std::exchange(number_, -1)));
}

void CgnsFile::fail(const std::string& what, const std::string& remedy) const {
  throw Error(use_ == Use::read ? ErrorKind::input : ErrorKind::output,
              fmt::format("{}: {}", shown_as_, what), remedy);
}

BCType_t cgns_condition(PatchType type) {
  switch (type) {
    case PatchType::farfield:
      return BCFarfield;
    case PatchType::symmetry:
      return BCSymmetryPlane;
    case PatchType::inlet:
      return BCInflow;
    case PatchType::outlet:
      return BCOutflow;
    case PatchType::wall:
      break;
  }
  return BCWall;
}

PatchType patch_type_of(BCType_t condition) {
  switch (condition) {
    case BCFarfield:
      return PatchType::farfield;
    case BCSymmetryPlane:
      return PatchType::symmetry;
    case BCInflow:
    case BCInflowSubsonic:
    case BCInflowSupersonic:
    case BCTunnelInflow:
      return PatchType::inlet;
    case BCOutflow:
    case BCOutflowSubsonic:
    case BCOutflowSupersonic:
    case BCTunnelOutflow:
      return PatchType::outlet;
    default:
      return PatchType::wall;
  }
}

}  // namespace flowcage
