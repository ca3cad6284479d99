// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "comminute/export.hpp"
#include "comminute/grading.hpp"
#include "comminute/view.hpp"

namespace comminute {

/// A piece of the log sizes over which a grading is spread, whose density may jump at either end.
struct Support {
    double lower;
    double upper;
};

/// Widths of the nodes that `ResolvedGrid::graded` makes.
struct NodeOptions {
    double spacing = 0.2;    ///< > 0, widest bin in ln(size)
    double grade = 0.8;      ///< > 0, bins next to a jump of the density, as a multiple of the fabric width
    Index support_bins = 8;  ///< >= 1, least number of bins to a support
};

/// Sizes of the resolved continuum: bins of uneven width in ln(size), and exact sizes between them.
///
/// Node 0 is the fines bin: it holds the mass of all that is finer, never crushes, and as a neighbour has the size of its
/// centre. Nodes rise; an exact size is a node of no width, above the bin that ends there.
///
/// @code{.cpp}
/// auto grid = comminute::ResolvedGrid::graded(0.05, -8.0, {0.0}, {});   // equal grains, fabric width 0.05
/// CHECK(grid.nodes() == 46);
/// CHECK(grid.exact(45));
/// CHECK(grid.lower(44) == doctest::Approx(-0.04));
/// @endcode
class COMMINUTE_API ResolvedGrid {
  public:
    /// Takes nodes as they are.
    /// @param lower, upper  (N) ends of the nodes in ln(size), the fines bin first
    /// @throws ShapeError for lists of two lengths or fewer than three nodes; ParameterError for a node that does not begin
    ///         where the one before it ends, a fines bin of no width, or two exact sizes that are one
    ResolvedGrid(std::vector<double> lower, std::vector<double> upper);

    /// Makes bins that are narrow below every exact size and both ends of every support, where the zone must be told from
    /// the jump, and widen in proportion to the distance from it.
    /// @param fabric_width  n, the scale of a zone's width
    /// @param bottom        upper end of the fines bin, below all other sizes
    /// @param exact         exact log sizes, in any order
    /// @param supports      pieces over which the rest of the mass is spread, in any order
    /// @param edges         log sizes that are to be ends of bins, such as sieves, where nothing jumps
    /// @throws ParameterError for a width or an option that is not greater than 0, or a size below the bottom
    static ResolvedGrid graded(double fabric_width, double bottom, std::vector<double> exact,
                               const std::vector<Support>& supports, const NodeOptions& options = {},
                               const std::vector<double>& edges = {});

    Index nodes() const { return static_cast<Index>(lower_.size()); }
    double lower(Index i) const { return VectorView<const double>(lower_)[i]; }
    double upper(Index i) const { return VectorView<const double>(upper_)[i]; }
    double centre(Index i) const { return 0.5 * (lower(i) + upper(i)); }
    double width(Index i) const { return upper(i) - lower(i); }
    /// Tells whether a node is an exact size.
    bool exact(Index i) const { return lower(i) == upper(i); }
    /// Number of bins: of the nodes that are no exact size.
    Index bins() const;
    /// (bins + 1) edges of the bins in ln(size). An exact size lies on the upper edge of the bin below it, and counts as
    /// part of that bin where masses are given by bin.
    std::vector<double> edges() const;

    /// Node that holds a log size: the exact size itself, or else the bin that it lies in, of two the finer one; 0 for all
    /// that is finer. @throws ParameterError for a size above the last node, or NaN
    Index node_of(double psi) const;

    friend bool operator==(const ResolvedGrid& a, const ResolvedGrid& b) {
        return a.lower_ == b.lower_ && a.upper_ == b.upper_;
    }

  private:
    std::vector<double> lower_;  // (N)
    std::vector<double> upper_;  // (N)
};

/// (N) mass of a grading by node; an exact size of the grading that no node has goes to the bin that holds it.
/// @throws ParameterError for grains above the grid
COMMINUTE_API std::vector<double> node_pmf(const Grading& grading, const ResolvedGrid& grid);

/// Nodes for a grading: its exact sizes, the ends of its spread, sieves as ends of bins, and a fines bin that begins at
/// least 8 in ln(size) below the largest grain and 1 below the size that a thousandth of the mass is finer than. A
/// lognormal or Rosin-Rammler spread ends at the size that 3e-7 of the mass is finer than.
/// @param edges  log sizes at which the curve is wanted: ends of bins too, and the fines bin begins below them; above the
///               largest grain there is nothing to tell
/// @throws ParameterError as `ResolvedGrid::graded`
COMMINUTE_API ResolvedGrid fitting_nodes(const Grading& grading, double fabric_width,
                                         const NodeOptions& options = {},
                                         const std::vector<double>& edges = {});
/// The same for several gradings, as the rows of a column have them.
COMMINUTE_API ResolvedGrid fitting_nodes(const std::vector<Grading>& gradings, double fabric_width,
                                         const NodeOptions& options = {},
                                         const std::vector<double>& edges = {});
/// The same for cells as they are: their exact sizes, and all others as one support, but for the finest thousandth.
/// @param psi    log sizes, at least one
/// @param exact  sizes among them that many cells have, as `LatticeState::points` gives them
COMMINUTE_API ResolvedGrid fitting_nodes(VectorView<const double> psi, const std::vector<PointMass>& exact,
                                         double fabric_width, const NodeOptions& options = {});

}  // namespace comminute
