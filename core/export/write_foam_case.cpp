#include "core/export/write_foam_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "core/base/atomic_file.hpp"
#include "core/base/error.hpp"
#include "core/export/patch_names.hpp"
#include "core/export/write_polymesh.hpp"

namespace flowcage {
namespace fs = std::filesystem;
namespace {

/// The turbulence of what flows in.
struct Inflow {
  double k = 0, omega = 0;
};

Inflow inflow_of(const FoamFlow& flow) {
  if (!flow.internal) {
    const double reynolds = flow.speed * flow.length / flow.viscosity;
    return {0.1 * flow.speed * flow.speed / reynolds, 5 * flow.speed / flow.length};
  }
  constexpr double intensity = 0.05, scale = 0.07, c_mu = 0.09;
  const double k = 1.5 * std::pow(intensity * flow.speed, 2);
  return {k, std::sqrt(k) / (std::pow(c_mu, 0.25) * scale * flow.length)};
}

std::string vector_text(const Vec3& v) {
  return fmt::format("({} {} {})", v.x(), v.y(), v.z());
}

class CaseMaker {
 public:
  CaseMaker(const HexView& mesh, const FoamFlow& flow)
      : mesh_(mesh), flow_(flow), names_(legal_patch_names(mesh).names), inflow_(inflow_of(flow)) {
    check();
  }

  std::vector<FoamCaseFile> files() {
    const Vec3 stream = flow_.speed * flow_.direction;
    const std::string velocity = vector_text(stream), still = "(0 0 0)";
    const bool resolved = flow_.yplus && *flow_.yplus <= resolved_yplus;
    const double nut = inflow_.k / inflow_.omega;
    field("U", "volVectorField", "[0 1 -1 0 0 0 0]", flow_.internal ? still : velocity,
          {"noSlip;", "freestreamVelocity; freestreamValue $internalField;",
           fmt::format("surfaceNormalFixedValue; refValue uniform {};", -flow_.speed),
           "inletOutlet; inletValue uniform (0 0 0); value uniform (0 0 0);"});
    field("p", "volScalarField", "[0 2 -2 0 0 0 0]", "0",
          {"zeroGradient;", "freestreamPressure; freestreamValue $internalField;", "zeroGradient;",
           "fixedValue; value uniform 0;"});
    // The flux through far field and inlets is that of U: potentialFoam's default would fix Phi there.
    field("Phi", "volScalarField", "[0 2 -1 0 0 0 0]", "0",
          {"zeroGradient;", "zeroGradient;", "zeroGradient;", "fixedValue; value uniform 0;"});
    const std::string flows_in = "inletOutlet; inletValue $internalField; value $internalField;";
    const std::string fixed = "fixedValue; value $internalField;";
    field("k", "volScalarField", "[0 2 -2 0 0 0 0]", fmt::format("{}", inflow_.k),
          {resolved ? "kLowReWallFunction; value $internalField;" : "kqRWallFunction; value $internalField;",
           flows_in, fixed, flows_in});
    field("omega", "volScalarField", "[0 0 -1 0 0 0 0]", fmt::format("{}", inflow_.omega),
          {"omegaWallFunction; value $internalField;", flows_in, fixed, flows_in});
    field("nut", "volScalarField", "[0 2 -1 0 0 0 0]", fmt::format("{}", nut),
          {resolved ? "nutLowReWallFunction; value uniform 0;" : "nutkWallFunction; value uniform 0;",
           "calculated; value $internalField;", "calculated; value $internalField;",
           "calculated; value $internalField;"});
    dictionary("constant", "transportProperties",
               fmt::format("transportModel Newtonian;\nnu [0 2 -1 0 0 0 0] {};\n", flow_.viscosity));
    dictionary("constant", "turbulenceProperties",
               "simulationType RAS;\nRAS { RASModel kOmegaSST; turbulence on; printCoeffs off; }\n");
    dictionary("system", "controlDict",
               "application simpleFoam;\nstartFrom startTime;\nstartTime 0;\nstopAt endTime;\nendTime 1000;\n"
               "deltaT 1;\nwriteControl timeStep;\nwriteInterval 1000;\npurgeWrite 0;\nwriteFormat binary;\n"
               "writePrecision 12;\ntimeFormat general;\ntimePrecision 6;\nrunTimeModifiable true;\n");
    dictionary("system", "fvSchemes",
               "ddtSchemes { default steadyState; }\n"
               "gradSchemes { default Gauss linear; limited cellLimited Gauss linear 1; grad(U) $limited; "
               "grad(k) $limited; grad(omega) $limited; }\n"
               "divSchemes\n{\n    default none;\n    div(phi,U) bounded Gauss linearUpwind limited;\n"
               "    div(phi,k) bounded Gauss upwind;\n    div(phi,omega) bounded Gauss upwind;\n"
               "    div((nuEff*dev2(T(grad(U))))) Gauss linear;\n"
               "    div(div(phi,U)) Gauss linear; // potentialFoam -writep\n}\n"
               "laplacianSchemes { default Gauss linear limited corrected 0.5; laplacian(1,Phi) Gauss linear "
               "corrected; }\n"
               "interpolationSchemes { default linear; }\nsnGradSchemes { default limited corrected 0.5; }\n"
               "wallDist { method meshWave; }\n");
    dictionary(
        "system", "fvSolution",
        "solvers\n{\n    Phi { solver GAMG; smoother DICGaussSeidel; tolerance 1e-8; relTol 0.01; }\n"
        "    p { solver GAMG; smoother DICGaussSeidel; tolerance 1e-8; relTol 0.05; }\n"
        "    \"(U|k|omega)\" { solver smoothSolver; smoother symGaussSeidel; tolerance 1e-9; relTol 0.1; "
        "nSweeps 1; }\n}\n"
        "potentialFlow { nNonOrthogonalCorrectors 20; PhiRefCell 0; PhiRefValue 0; }\n"
        "SIMPLE\n{\n    consistent yes;\n    nNonOrthogonalCorrectors 0;\n    pRefCell 0;\n    pRefValue "
        "0;\n    residualControl { p 1e-5; U 1e-5; \"(k|omega)\" 1e-5; }\n}\n"
        "relaxationFactors { fields { p 0.9; } equations { U 0.8; k 0.7; omega 0.7; } }\n");
    return std::move(files_);
  }

 private:
  bool has(PatchType type) const {
    return std::ranges::any_of(mesh_.patches(), [type](const BoundaryPatch& p) { return p.type == type; });
  }

  void check() const {
    const bool way_out = has(PatchType::outlet) || has(PatchType::farfield);
    if (!way_out) {
      throw Error(ErrorKind::input,
                  has(PatchType::inlet) ? "--case: the fluid flows in and has no way out"
                                        : "--case: the fluid has neither inlet nor outlet nor far field",
                  "name the CAD's faces with --inlet and --outlet");
    }
    if (has(PatchType::outlet) && !has(PatchType::farfield) && !has(PatchType::inlet)) {
      throw Error(ErrorKind::input, "--case: the fluid has an outlet and no inlet",
                  "name the CAD's faces with --inlet");
    }
    if (!has(PatchType::farfield)) return;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const BoundaryPatch& patch = mesh_.patches()[i];
      if (patch.type != PatchType::symmetry || patch.quads.empty()) continue;
      Vec3 area = Vec3::Zero();
      double size = 0;
      for (const auto& q : patch.quads) {
        const auto p = mesh_.points();
        const Vec3 own = (p[q[2]] - p[q[0]]).cross(p[q[3]] - p[q[1]]) / 2;
        area += own;
        size += own.norm();
      }
      if (std::abs(area.dot(flow_.direction)) <= 1e-6 * size) continue;
      throw Error(ErrorKind::input,
                  fmt::format("--direction: the stream {} flows through the symmetry plane {}",
                              vector_text(flow_.direction), names_[i]),
                  "give a direction in that plane, or mesh the whole body");
    }
  }

  /// Conditions of walls, far field, inlets and outlets.
  struct Conditions {
    std::string wall, farfield, inlet, outlet;
  };

  void field(const std::string& name, const char* kind, const char* dimensions, const std::string& value,
             const Conditions& conditions) {
    std::string text =
        foam_header(kind, "0", name) +
        fmt::format("dimensions {};\ninternalField uniform {};\nboundaryField\n{{\n", dimensions, value);
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const BoundaryPatch& patch = mesh_.patches()[i];
      std::string condition;
      switch (patch.type) {
        case PatchType::wall:
          condition = conditions.wall;
          break;
        case PatchType::farfield:
          condition = conditions.farfield;
          break;
        case PatchType::symmetry:
          condition = foam_patch_type(mesh_, patch) + ";";
          break;
        case PatchType::inlet:
          condition = conditions.inlet;
          break;
        case PatchType::outlet:
          condition = conditions.outlet;
          break;
      }
      text += fmt::format("    {} {{ type {} }}\n", names_[i], condition);
    }
    files_.push_back({fs::path("0") / name, text + "}\n"});
  }

  void dictionary(const std::string& folder, const std::string& name, const std::string& body) {
    files_.push_back({fs::path(folder) / name, foam_header("dictionary", folder, name) + body});
  }

  const HexView& mesh_;
  const FoamFlow& flow_;
  const std::vector<std::string> names_;
  const Inflow inflow_;
  std::vector<FoamCaseFile> files_;
};

}  // namespace

std::vector<FoamCaseFile> foam_case_files(const HexView& mesh, const FoamFlow& flow) {
  return CaseMaker(mesh, flow).files();
}

void check_case_folder(const fs::path& case_folder) {
  std::error_code ignored;
  const fs::path root = fs::weakly_canonical(fs::absolute(case_folder), ignored).lexically_normal();
  for (const char* name : {"0", "constant", "system"}) {
    const fs::path folder = case_folder / name, real = fs::weakly_canonical(fs::absolute(folder), ignored);
    const auto inside = real.lexically_relative(root);
    if (!inside.empty() && *inside.begin() != "..") continue;
    throw Error(ErrorKind::output,
                fmt::format("{}: leads out of the case, to {}", folder.string(), real.string()),
                "remove the link, or choose another place with -o");
  }
}

void write_foam_case(const fs::path& case_folder, const std::vector<FoamCaseFile>& files) {
  if (files.empty()) return;
  check_case_folder(case_folder);
  std::set<fs::path> folders;
  for (const FoamCaseFile& file : files) folders.insert(case_folder / file.path.parent_path());
  for (const fs::path& folder : folders) {
    std::error_code failed;
    fs::create_directories(folder, failed);
    if (!failed) continue;
    throw Error(ErrorKind::output,
                fmt::format("{}: cannot make the folder: {}", folder.string(), failed.message()),
                "choose another place with -o");
  }
  std::vector<std::unique_ptr<AtomicFile>> stored;
  for (const FoamCaseFile& file : files) {
    const fs::path target = case_folder / file.path;
    std::error_code ignored;
    if (fs::is_symlink(target, ignored)) {  // else the link's end would be replaced
      throw Error(ErrorKind::output, fmt::format("{}: is a link", target.string()),
                  "remove the link, or choose another place with -o");
    }
    stored.push_back(std::make_unique<AtomicFile>(target));
    stored.back()->stream() << file.text;
  }
  for (const auto& file : stored) file->commit();
  std::error_code ignored;
  fs::remove(case_folder / "0" / "phi", ignored);
}

}  // namespace flowcage
