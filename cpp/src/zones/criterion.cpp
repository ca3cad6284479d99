// SPDX-License-Identifier: BSD-3-Clause
// Crushing criterion and crush zones, tested at exact places and bin centres (docs/theory/one_sweep.md, section 1).
#include "comminute/criterion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/arrays.hpp"
#include "base/check.hpp"
#include "zones/shell_zone.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double epsilon = std::numeric_limits<double>::epsilon();

void require_finite_width(const Material& material) {
    material.validate();
    require(std::isfinite(material.fabric_width), "fabric_width", material.fabric_width,
            "finite here: g of Eq. 15 has no value where the fabric is off");
}

}  // namespace

double critical_stress_ratio(const Material& material, double size, double neighbour_size) {
    material.validate();
    require(size > 0.0, "size", size, "greater than 0");
    require(neighbour_size > 0.0, "neighbour_size", neighbour_size, "greater than 0");
    const double contrast = std::log(size / neighbour_size) / material.fabric_width;
    return std::pow(size / material.reference_size, -3.0 / material.weibull_modulus) *
           std::exp(0.5 * contrast * contrast);
}

double stress_function(const Material& material, double psi, double psibar) {
    require_finite_width(material);
    return (psi - psibar) * (psi - psibar) - material.k() * psi;
}

double logspace_load(const Material& material, double stress_ratio) {
    require_finite_width(material);
    require_stress_ratio(stress_ratio);
    const double n = material.fabric_width;
    return 2.0 * n * n *
           (std::log(stress_ratio) - 3.0 / material.weibull_modulus * std::log(material.reference_size));
}

double stress_ratio_at(const Material& material, double logspace_load) {
    require_finite_width(material);
    const double n = material.fabric_width;
    return std::exp(logspace_load / (2.0 * n * n)) *
           std::pow(material.reference_size, 3.0 / material.weibull_modulus);
}

CrushZones::CrushZones(const LogGrid& grid, const Material& material, double stress_ratio)
    : grid_(grid),
      material_(material),
      band_(Array<Index>(grid.bins()).vector()),
      overlap_(Array<Index>(grid.bins()).vector()) {
    material_.validate_sharp();
    strength_ = 3.0 / material_.weibull_modulus;
    log_reference_ = std::log(material_.reference_size);
    magnitude_ = std::max({std::abs(grid_.psi_min()), std::abs(grid_.psi_max()), std::abs(log_reference_)});
    set_load(stress_ratio);
}

// Eq. 15 divided by 2 n^2, so that an infinite fabric width needs no special case. The slack of a few units
// in the last place keeps the zone closed: psi = ln s_max at sigma* = 1 must crush however its bin centre was
// rounded.
bool CrushZones::crushes(double psi, double distance) const {
    if (log_load_ == -infinity) return false;
    const double contrast = distance / material_.fabric_width;
    const double cushion = 0.5 * contrast * contrast;
    if (std::isinf(cushion)) return false;  // the square of so narrow a fabric underflows
    const double rounding = strength_ * magnitude_ + contrast * magnitude_ / material_.fabric_width;
    const double slack = 8.0 * epsilon * (std::abs(log_load_) + rounding);
    return log_load_ + strength_ * (psi - log_reference_) + slack >= cushion;
}

void CrushZones::set_load(double stress_ratio) {
    require_stress_ratio(stress_ratio);
    stress_ratio_ = stress_ratio;
    log_load_ = std::log(stress_ratio);
    const double h = grid_.spacing();
    const VectorView<Index> band(band_);
    const VectorView<Index> overlap(overlap_);
    band[0] = overlap[0] = -1;
    for (Index m = 1; m < grid_.bins(); ++m) {
        const double psi = grid_.centre(m);
        const auto larger = [&](Index d) { return crushes(psi, static_cast<double>(d) * h); };
        const auto smaller = [&](Index d) {
            return crushes(grid_.centre(m - d), static_cast<double>(d) * h);
        };
        // The root of Eq. 15 is right but for rounding; the test itself decides about the bins next to it.
        Index d = static_cast<Index>(std::clamp(half_width(psi) / h, -1.0, static_cast<double>(m)));
        while (d < m && larger(d + 1)) ++d;
        while (d >= 0 && !larger(d)) --d;
        band[m] = d;
        while (d >= 0 && !smaller(d)) --d;
        overlap[m] = d;
    }
}

bool CrushZones::active(double psi, double psibar) const {
    return crushes(std::max(psi, psibar), std::abs(psi - psibar));
}

void CrushZones::fill(MatrixView<std::uint8_t> zones) const {
    require_square(zones, grid_.bins(), "zones");
    for (Index i = 0; i < grid_.bins(); ++i) {
        for (Index j = 0; j < grid_.bins(); ++j) zones(i, j) = static_cast<std::uint8_t>(at(i, j));
    }
}

double CrushZones::half_width(double psi) const {
    if (!crushes(psi, 0.0)) return -1.0;
    const double excess = log_load_ + strength_ * (psi - log_reference_);
    const double n = material_.fabric_width;
    return std::isinf(n) ? infinity : n * std::sqrt(2.0 * std::max(excess, 0.0));
}

double CrushZones::distrusted_below() const {
    if (std::isinf(material_.fabric_width)) return -infinity;
    for (Index m = grid_.bins() - 1; m > 0; --m) {
        if (band(m) == m) return grid_.psi_min() + 2.0 * half_width(grid_.centre(m));
    }
    return -infinity;
}

double active_share(const LogGrid& grid, const Material& material, double stress_ratio, Index m,
                    Index distance) {
    material.validate_sharp();
    require_stress_ratio(stress_ratio);
    require(m >= 0 && m < grid.bins(), "m", static_cast<double>(m), "a bin of the grid");
    require(distance >= 0 && distance <= m, "distance", static_cast<double>(distance), "between 0 and m");
    if (m == 0 || stress_ratio == 0.0) return 0.0;
    double share[lanes];
    ShellZones(grid, material, std::log(stress_ratio)).shares(m, {distance}, 1, share);
    return share[0];
}

void active_share(const LogGrid& grid, const Material& material, double stress_ratio,
                  MatrixView<double> share) {
    material.validate_sharp();
    require_stress_ratio(stress_ratio);
    require_square(share, grid.bins(), "share");
    const Index bins = grid.bins();
    const ShellZones zones(grid, material, std::log(stress_ratio));
    Array<double> of_shells((bins + lanes) * lanes);  // (distances, lanes)
    for (Index begin = 0; begin < bins; begin += lanes) {
        const Index end = std::min(begin + lanes, bins);
        zones.shares(begin, {}, end, of_shells.data());
        for (Index m = begin; m < end; ++m) {
            for (Index d = 0; d <= m; ++d) {
                const double of_cell = of_shells[d * lanes + m - begin];
                share(m, m - d) = share(m - d, m) = m == 0 ? 0.0 : of_cell;
            }
        }
    }
}

}  // namespace comminute
