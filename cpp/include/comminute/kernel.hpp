// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "comminute/criterion.hpp"
#include "comminute/export.hpp"

namespace comminute {

/// Rules for the crushes of one step.
enum class KernelKind {
    exact,  ///< Eq. 59: each grain by its own zone, both in zone 11
    slow,   ///< Eq. 63 (cases by size put right): the larger grain alone, half of each among equals
    fast,   ///< Eq. 68: both grains wherever either would crush
    blend,  ///< Eq. 67: (1 - loading_rate) slow + loading_rate fast
};

/// Choices of a Kernel, and of the engine that steps with it.
struct KernelOptions {
    KernelKind kind = KernelKind::slow;
    double loading_rate = 0.0;             ///< in [0, 1], share of the fast kernel; above 0 for a blend alone
    Scheme scheme = Scheme::conservative;  ///< of the fragments; zones are tested at bin centres under either
    friend bool operator==(const KernelOptions& a, const KernelOptions& b) {
        return a.kind == b.kind && a.loading_rate == b.loading_rate && a.scheme == b.scheme;
    }
};

/// Shares of an active cell's mass that crush in psi alone, in psibar alone and in both in one step; their sum is 1.
struct CrushShares {
    double grain = 0.0;      ///< psi alone
    double neighbour = 0.0;  ///< psibar alone
    double both = 0.0;
};

/// The crushing kernel K of Eq. 61 on a grid. Immutable: one object may serve any number of threads.
///
/// Mass in an active cell leaves it and is spread by that cell's own kernel (Eq. 38); mass that would fall
/// off the bottom of an axis stays in that axis' bin 0.
///
/// @throws ParameterError for a bad material, a loading rate outside [0, 1], or one above 0 for another kind than
///         `blend`
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 1.0, 64);
/// comminute::Kernel kernel(grid, comminute::Material{});
/// std::vector<double> k(64 * 64);
/// kernel.cell(60, 59, 100.0, {k.data(), 64, 64});   // the larger grain, psi, crushes: one column
/// CHECK(k[59 * 64 + 59] == doctest::Approx(kernel.fragments().mass[1]));
/// @endcode
class COMMINUTE_API Kernel {
  public:
    Kernel(const LogGrid& grid, const Material& material, const KernelOptions& options = {});

    const LogGrid& grid() const { return grid_; }
    const Material& material() const { return material_; }
    const KernelOptions& options() const { return options_; }
    /// One crush on this grid, under the scheme of the options.
    const FragmentPmf& fragments() const { return fragments_; }

    /// Shares of cell (i, j) that crush in one step if it lies in `zone`, which is not Zone::rest.
    CrushShares shares(Zone zone, Index i, Index j) const;

    /// Places to which unit mass of cell (i, j) goes in one step under this load (Fig. 5).
    /// @param out  (N, N), overwritten; sums to 1
    /// @throws ParameterError for a cell off the grid or a bad load, ShapeError for another shape
    void cell(Index i, Index j, double stress_ratio, MatrixView<double> out) const;

  private:
    LogGrid grid_;
    Material material_;
    KernelOptions options_;
    FragmentPmf fragments_;
};

/// Report of one step, or of a run of steps. Masses are in the unit of the state (its total, usually 1).
struct StepReport {
    double active = 0.0;   ///< mass inside the zone when the last step began
    double crushed = 0.0;  ///< mass crushed in psi, every crush counted, those that stay in their bin too
    double crushed_neighbour = 0.0;  ///< the same in psibar
    Index steps = 0;                 ///< number of steps
    Index terms =
        0;  ///< K, terms of the exponential sum with which the last step spread mass; 0 if without one
};

}  // namespace comminute
