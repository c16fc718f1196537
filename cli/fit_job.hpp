#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cli/json_report.hpp"
#include "core/limit/bicubic_patches.hpp"
#include "core/mesh/cage.hpp"
#include "core/mesh/hex_view.hpp"
#include "core/options.hpp"
#include "core/pipeline.hpp"
#include "core/refit/prepare_cage.hpp"
#include "occ_bridge/cad_model.hpp"

namespace flowcage {

/// What the commands surface and mesh share: their inputs, gates and JSON.
struct FitInputs {
  CadModel cad;
  bool drawn = true;                ///< a cage was given
  Cage cage{};                      ///< in metres, as the linter left it
  std::optional<HexMesh> blocks{};  ///< instead of a cage: the user's blocks, in metres
  PreparedCage::Creases creases = PreparedCage::Creases::none;
  LintReport lint{};     ///< places in metres
  double cage_unit = 1;  ///< metres
  double read_seconds = 0;
};

/// Reads the CAD files and the cage and makes it ready (prepare_cage.hpp). Without --cage: the CAD alone.
FitInputs read_fit_inputs(const Options& options, Progress& progress);

/// How the options want CAD to be read.
CadReadSettings cad_settings(const Options& options);

/// How the options want automatic blocks to be made.
AmbientSettings ambient_settings(const Options& options);

/// The unit of cage and block files, in metres: --cage-unit, else the CAD's.
double cage_unit_in_metres(const Options& options, const CadModel& cad);

/// Whether --cage names blocks (a hex mesh file) rather than a polyhedron.
bool is_block_file(const std::string& name);

/// A cage file in metres; unit as read_fit_inputs found it.
Cage read_cage_in_metres(const std::string& file, double unit);

/// Without --levels: up to `most` levels, as many as the tolerance needs.
FitSettings fit_settings(const Options& options, const FitInputs& inputs, int most);

/// A missed gate as an exception: the first one with its place, the others in the remedy. Nothing if all
/// hold.
void require_gates(const std::vector<Gate>& gates);

/// The contract's "cage", "surface" and "gates".
Json cage_json(const FitInputs& inputs, const Cage& cage, const Options& options);
Json surface_json(const SurfaceFit& fit);
Json gates_json(const std::vector<Gate>& gates);

/// "step" of the contract's "surface": B-spline patches; `diagonal` is the CAD's, in metres.
Json step_json(const PatchSurface& patches, double diagonal);

/// Largest memory of this process so far.
Offset peak_memory_bytes();

}  // namespace flowcage
