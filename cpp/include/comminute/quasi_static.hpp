// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/fabric.hpp"
#include "comminute/material.hpp"
#include "comminute/scheme.hpp"

namespace comminute {

/// Ways in which a solve adds up the fragments.
enum class SolvePath {
    automatic,  ///< the cheapest for this law and this zone
    direct,     ///< bin by bin along the zone's width
    sums,       ///< running sums of the law's exponential sum, for reductions beyond its head
    blend,      ///< only reported: bin by bin over the whole state, the path of a loading rate above 0
    narrow,     ///< only reported: cell by cell in a zone of a few bins, many problems side by side
    none,       ///< only reported: nothing had to move
};

/// Choices of a QuasiStatic.
struct QuasiStaticOptions {
    Scheme scheme = Scheme::conservative;  ///< of the fragments and of the zones
    double loading_rate = 0.0;             ///< in [0, 1], share of the fast kernel (Eq. 67)
    SolvePath path = SolvePath::automatic;
    friend bool operator==(const QuasiStaticOptions& a, const QuasiStaticOptions& b) {
        return a.scheme == b.scheme && a.loading_rate == b.loading_rate && a.path == b.path;
    }
};

/// Report of one solve: its path and its crushed mass. Masses are shares of the whole.
struct SolveReport {
    SolvePath path = SolvePath::none;
    Index terms = 0;         ///< K, number of terms of the exponential sum; 0 on a path without one
    Index head = 0;          ///< H, largest reduction in bins that was added without the sum
    double fit_error = 0.0;  ///< largest error of the sum, as a share of the largest fragment bin
    double crushed = 0.0;    ///< mass crushed in psi, every crush counted, those that stay in their bin too
    double crushed_neighbour = 0.0;  ///< the same in psibar
};

/// Grading after a solve, without the state.
struct Marginal {
    std::vector<double> grainsize;  ///< (N) mass by bin, point masses in theirs
    std::vector<PointMass> points;  ///< the part of it that is still at exact sizes, fine to coarse
    SolveReport report;

    /// Total less 1. It is summed with twice the digits, since rounding of its own would be as large.
    COMMINUTE_API double mass_error() const;
};

/// The state to which infinitely slow loading leads, in one sweep from coarse to fine.
///
/// Under the slow rule (Eq. 63) the move of a packet of mass depends on its place alone; the load only decides whether
/// it must move, and zones only grow. Every packet stops at the first place outside the zone of the largest load so
/// far, whatever the steps between: one solve equals any slow path to the same load. That holds for the blend
/// (Eq. 67) at a constant rate too, and not for the exact kernel (Eq. 59), which has no solve.
///
/// Costs O(K N W) for a grading, W the zone's width in bins and K the terms of the law's exponential sum, or O(N W^2)
/// where that is less; a state costs N^2 more. A loading rate above 0 costs O(N^3). Point masses of a Fabric stay
/// exact under the conservative scheme; the paper's scheme puts them on bin centres. The derivation stands in
/// docs/theory/one_sweep.md, section 2.
///
/// Begin-state in, end-state out. One object per thread; a copy has a workspace of its own and costs no set-up.
/// Many states at once: BatchSolver.
///
/// @throws ParameterError for a bad material, a loading rate outside [0, 1], or a path that is only reported
///
/// @code{.cpp}
/// comminute::LogGrid grid(-8.0, 0.0, 201);
/// comminute::QuasiStatic solver(grid, comminute::Material{});
/// auto start = comminute::mixed_fabric(comminute::monodisperse(1.0), grid);
/// comminute::SolveReport report;
/// auto after = solver.solve(start, 1.0, &report);
/// CHECK(report.crushed == doctest::Approx(0.5));     // of two equal grains either may be the first
/// CHECK(after.settled_at() == 1.0);
/// CHECK(solver.solve(after, 0.5) == after);          // unloading changes nothing
/// @endcode
class COMMINUTE_API QuasiStatic {
  public:
    QuasiStatic(const LogGrid& grid, const Material& material, const QuasiStaticOptions& options = {});
    ~QuasiStatic();
    QuasiStatic(const QuasiStatic& other);
    QuasiStatic& operator=(const QuasiStatic& other);
    QuasiStatic(QuasiStatic&&) noexcept;
    QuasiStatic& operator=(QuasiStatic&&) noexcept;

    const LogGrid& grid() const;
    const Material& material() const;
    const QuasiStaticOptions& options() const;
    /// Takes another material, as a new solver would have it, in the memory of this one: for many materials in turn. The
    /// tables of the fragments are kept where their law is the same.
    /// @throws ParameterError for a bad material
    void set_material(const Material& material);

    /// @param state  on this grid
    /// @return the state at rest under the larger of `stress_ratio` and `state.settled_at()`
    /// @throws ParameterError for a bad load or a state on another grid
    Fabric solve(const Fabric& state, double stress_ratio, SolveReport* report = nullptr);

    /// The grading at rest, without the state. Without a loading rate it reads only the zone's band of the state.
    Marginal marginal(const Fabric& state, double stress_ratio);
    /// The grading under each of many loads, as marginal() gives it one by one; narrow zones are swept side by side.
    /// @param stress_ratios  in any order: each is applied to `state` itself
    std::vector<Marginal> marginals(const Fabric& state, VectorView<const double> stress_ratios);

    /// Solves for a bare array, without point masses.
    /// @param state       (N, N), entries in the zone must be finite and at least 0 (-1e-12 for rounding)
    /// @param settled_at  load under which it is at rest; none for a state that was never loaded
    /// @param out         (N, N) state at rest; may be `state` itself
    /// @param largest     size that no grain exceeds, which Fabric::largest() is for a fabric; 0 where it is not known
    /// @throws ShapeError for other shapes or a partial overlap; ParameterError for a bad load or largest size, an entry
    ///         in the zone that is no mass, or masses whose sum overflows; after the last, `out` has no meaning
    SolveReport solve(MatrixView<const double> state, double stress_ratio, std::optional<double> settled_at,
                      MatrixView<double> out, double largest = 0.0);
    /// The grading at rest for a bare array.
    /// @param grainsize  (N) out: mass by grainsize
    SolveReport marginal(MatrixView<const double> state, double stress_ratio,
                         std::optional<double> settled_at, VectorView<double> grainsize,
                         double largest = 0.0);

  private:
    friend class BatchSolver;
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace comminute
