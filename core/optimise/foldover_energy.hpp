#pragma once
#include <span>
#include <vector>

#include "core/base/csr.hpp"
#include "core/optimise/hex_corner.hpp"

namespace flowcage {

/// The part of a hex mesh that is optimised: every cell that touches a moving point, no other.
/// Units: lengths are divided by a power of two near the mesh's size, so that nothing over- or underflows.
struct FoldoverProblem {
  std::vector<HexPoints> cells;                        ///< into the positions that evaluate_energy is given
  std::vector<Index> moving;                           ///< #M, positions that may move, ascending
  Csr<Offset> moving_corners;                          ///< #M, 8 * cell + corner of each corner at that point
  std::vector<std::array<float, 12>> inverse_lengths;  ///< #cells, 1 / target length of each edge
  /// #cells. Thorough: 19 more samples (edge and face midpoints, centre), for cells whose corners do not
  /// prove them valid. Hopeless: stays regularised when all other cells are held invertible.
  struct CellKind {
    bool thorough = false, hopeless = false;
  };
  std::vector<CellKind> kinds;
};

/// Rows of `moving_corners` from cells and moving. Precondition: entries of cells are below point_count.
Csr<Offset> corners_of_points(std::span<const HexPoints> cells, std::span<const Index> moving,
                              Index point_count);

/// Weights of the energy's terms and its regularisation.
struct EnergyParameters {
  double lambda = 0.3;             ///< of the volume term against the shape term
  double epsilon = 0;              ///< 0: a true barrier, infinite at det J <= 0
  double hopeless_epsilon = 1e-3;  ///< instead of epsilon in hopeless cells, there with exponent 1
  int exponent = 1;                ///< p >= 1: larger ones lift the worst samples more
};

struct EnergyValue {
  double energy = 0;  ///< mean over the cells; 3 + 2 lambda is the least a cell can have; may be infinite
  double min_determinant = 0;  ///< least det J over the samples of all cells but the hopeless; target cell: 1
};

/// Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, "Foldover-free maps in 50 lines of code", ACM TOG
/// 40 (2021), for d = 3: the sum over samples of
///   phi = tr(J^T J) / chi^(2/3) + lambda (det^2 J + 1) / chi,  chi = (det J + sqrt(epsilon^2 + det^2 J)) /
///   2,
/// here generalised to phi (phi / m)^(p - 1) with m = 3 + 2 lambda, the least value that phi can have, which
/// it has on target cells. J maps a box of the target lengths to the cell. Samples are the eight corners
/// (each with the target lengths of its own three edges, so that a tapered cell keeps its taper), in thorough
/// cells 19 more. `gradient`: #M, derivative by each moving point; empty: the energy alone. `positions`:
/// every point. The same bits for any number of threads.
EnergyValue evaluate_energy(const FoldoverProblem& problem, std::span<const Vec3> positions,
                            const EnergyParameters& parameters, std::span<Vec3> gradient);

/// Symmetric positive definite 3x3 blocks close to the energy's second derivative by each moving point alone
/// (exact up to terms that may be negative): the preconditioner. #M.
std::vector<Eigen::Matrix3d> energy_blocks(const FoldoverProblem& problem, std::span<const Vec3> positions,
                                           const EnergyParameters& parameters);

}  // namespace flowcage
