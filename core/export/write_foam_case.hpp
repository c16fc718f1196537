#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// The flow that an OpenFOAM case is set up for: incompressible, steady. SI units, the mesh in metres.
struct FoamFlow {
  double speed = 1;               ///< of the free stream, or at the inlets
  Vec3 direction{1, 0, 0};        ///< of the free stream; unit length
  double viscosity = 1.5e-5;      ///< kinematic, m2/s
  double length = 1;              ///< of the body, or across an inlet: for the turbulence that flows in
  bool internal = false;          ///< what flows in has the turbulence of a duct, not of free air
  std::optional<double> yplus{};  ///< of the first points off the wall, if it is known
};

/// y+ up to which walls are resolved; above, wall functions bridge the viscous sublayer.
inline constexpr double resolved_yplus = 5;

/// The files of a case that potentialFoam and simpleFoam (k-omega SST) start on, relative to the case folder:
/// 0/U, p, Phi, k, omega, nut; constant/transportProperties, turbulenceProperties; system/controlDict,
/// fvSchemes, fvSolution.
///
/// Walls: no slip; with y+ <= resolved_yplus the low-Reynolds conditions of nut and k, else wall functions
/// (omega's is valid at any y+). Far field: freestreamVelocity and freestreamPressure. Inlets: `speed` normal
/// to the patch. Outlets: p = 0. Symmetry: symmetryPlane or symmetry, as write_polymesh writes the patch. Phi
/// (potentialFoam): fixed at outlets, elsewhere the flux of U. Far field turbulence: omega = 5 U / L, k = 0.1
/// U^2 / Re (the bounds that NASA's turbulence modeling resource gives for SST); inlets: intensity 5 %,
/// length scale 0.07 L.
struct FoamCaseFile {
  std::filesystem::path path;
  std::string text;
};
/// Throws Error(input) where no flow is possible: an inlet without an outlet or far field, no opening at all,
/// or a free stream through a symmetry plane.
std::vector<FoamCaseFile> foam_case_files(const HexView& mesh, const FoamFlow& flow);

/// Refuses a case folder with a folder of the case that is a link to a place outside of it. Throws
/// Error(output). To be called before long work.
void check_case_folder(const std::filesystem::path& case_folder);

/// Writes them below `case_folder`, replacing older ones, each whole or not at all; the results of an earlier
/// run in 0 (phi, which would be read) are removed. Throws Error(output), also where a folder of the case is
/// a link that leads out of it.
void write_foam_case(const std::filesystem::path& case_folder, const std::vector<FoamCaseFile>& files);

}  // namespace flowcage
