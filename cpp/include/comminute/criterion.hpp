// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/grid.hpp"
#include "comminute/material.hpp"

namespace comminute {

/// Stress ratio at which a grain crushes beside neighbours of mean size `neighbour_size` (Eq. 2).
/// @param size, neighbour_size  > 0, in the unit of the material's reference size
/// @throws ParameterError for a size that is not positive
///
/// @code{.cpp}
/// comminute::Material m;
/// CHECK(comminute::critical_stress_ratio(m, 1.0, 1.0) == doctest::Approx(1.0));
/// CHECK(comminute::critical_stress_ratio(m, 1.0, 0.9) > 9.0);   // cushioned by smaller neighbours
/// @endcode
COMMINUTE_API double critical_stress_ratio(const Material& material, double size, double neighbour_size);

/// Log-space stress function g(psi, psibar) = (psi - psibar)^2 - k psi (Eq. 15). Needs a finite fabric width.
COMMINUTE_API double stress_function(const Material& material, double psi, double psibar);

/// Log-space load g* = 2 n^2 ln(sigma* / s_max^(3/w)) (Eq. 15); -inf for no load. Needs a finite fabric
/// width.
COMMINUTE_API double logspace_load(const Material& material, double stress_ratio);

/// Stress ratio at a log-space load, the inverse of logspace_load. Needs a finite fabric width.
COMMINUTE_API double stress_ratio_at(const Material& material, double logspace_load);

/// The grains of a cell (psi, psibar) that the load crushes (Eqs. 52-55).
enum class Zone : std::uint8_t {
    rest = 0,       ///< 00: neither
    neighbour = 1,  ///< 01: psibar alone
    grain = 2,      ///< 10: psi alone
    both = 3,       ///< 11: either would
};

/// The four crush zones on a grid, tested at bin centres, held as two integers a shell.
///
/// Shell m is the set of cells whose larger index is m. For k > 0 the larger grain is always the first to
/// crush, so in shell m the cells at distance |i - j| <= band(m) are active, those at <= overlap(m) lie in
/// zone 11, and what is between lies in 10 (i > j) or 01 (i < j). Zones are closed, to rounding: a grain
/// exactly at its critical load crushes. The cell (0, 0), fines among fines, never does.
///
/// @throws ParameterError for a bad material, or a stress ratio that is negative or NaN
///
/// @code{.cpp}
/// comminute::CrushZones zones(comminute::LogGrid(-6.0, 1.0, 351), comminute::Material{}, 1.0);
/// CHECK(zones.at(300, 300) == comminute::Zone::both);   // psi = 0 among equals, at the closed edge
/// CHECK(zones.at(299, 299) == comminute::Zone::rest);
/// @endcode
class COMMINUTE_API CrushZones {
  public:
    CrushZones(const LogGrid& grid, const Material& material, double stress_ratio);

    /// Moves the zones to another load. Allocates nothing.
    /// @throws ParameterError for a stress ratio that is negative or NaN
    void set_load(double stress_ratio);

    double stress_ratio() const { return stress_ratio_; }
    const LogGrid& grid() const { return grid_; }
    const Material& material() const { return material_; }

    /// Largest |i - j| that is active in shell m; -1 where none is.
    Index band(Index m) const { return VectorView<const Index>(band_)[m]; }
    /// Largest |i - j| in shell m at which both grains crush; -1 where none is.
    Index overlap(Index m) const { return VectorView<const Index>(overlap_)[m]; }

    Zone at(Index i, Index j) const {
        const Index larger = i > j ? i : j;
        const Index distance = i > j ? i - j : j - i;
        if (distance > band(larger)) return Zone::rest;
        if (distance <= overlap(larger)) return Zone::both;
        return i > j ? Zone::grain : Zone::neighbour;
    }

    /// Tells whether a pair of exact log sizes lies in the slow zone: its larger grain crushes, or either of two equal ones.
    bool active(double psi, double psibar) const;

    /// Writes the zone of every cell.
    /// @param zones  (N, N) out: values of Zone
    /// @throws ShapeError for another shape
    void fill(MatrixView<std::uint8_t> zones) const;

    /// Half-width W of the zone, in psi, where the larger grain has log size psi: sqrt(g* + k psi);
    /// 0 at the tip, -1 where nothing crushes, inf where the fabric is off.
    double half_width(double psi) const;

    /// Log size below which a load on a packing that was mixed once is not exact, because the zone reaches the fines bin,
    /// whose grains are treated as if they had its centre's size; -inf where the zone keeps clear of it (or sizes alone
    /// decide). A later mixing hands the error on to larger grains.
    double distrusted_below() const;

  private:
    bool crushes(double psi, double distance) const;

    LogGrid grid_;
    Material material_;
    double stress_ratio_ = 0.0;
    double log_load_ = 0.0;  // ln sigma*
    double strength_ = 0.0;  // 3 / w
    double log_reference_ = 0.0;
    double magnitude_ = 0.0;      // largest |log size| in play, to which rounding is proportional
    std::vector<Index> band_;     // (N)
    std::vector<Index> overlap_;  // (N)
};

/// Share of each cell's area that lies inside the slow crush zone (the larger grain crushes), with mass taken
/// as uniform over the cell: the sub-cell counterpart of CrushZones, exact for any width of the zone.
///
/// @param share  (N, N), values in [0, 1], symmetric; cell (0, 0) is 0
/// @throws ParameterError, ShapeError as CrushZones
COMMINUTE_API void active_share(const LogGrid& grid, const Material& material, double stress_ratio,
                                MatrixView<double> share);

/// Share of one cell: of shell m, at |i - j| = distance.
/// @throws ParameterError also for a shell or a distance off the grid
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 1.0, 351);
/// // At psi = 0 and sigma* = 1 the tip of the zone cuts the cell in two; all below the tip is at rest.
/// double share = comminute::active_share(grid, comminute::Material{}, 1.0, 300, 0);
/// CHECK(share > 0.0);
/// CHECK(share < 1.0);
/// @endcode
COMMINUTE_API double active_share(const LogGrid& grid, const Material& material, double stress_ratio, Index m,
                                  Index distance);

}  // namespace comminute
