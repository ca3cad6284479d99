// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/kernel.hpp"

#include <algorithm>

#include "base/check.hpp"

namespace comminute {

using namespace detail;

namespace {

// Where one unit of mass in bin `from` of a line lies after one crush.
std::vector<double> spread(const FragmentPmf& fragments, Index from) {
    std::vector<double> line(fragments.mass.size(), 0.0);
    for (Index m = 0; m < from; ++m) {
        line[static_cast<std::size_t>(from - m)] = fragments.mass[static_cast<std::size_t>(m)];
    }
    line[0] = fragments.below[static_cast<std::size_t>(from)];
    return line;
}

}  // namespace

Kernel::Kernel(const LogGrid& grid, const Material& material, KernelKind kind, double loading_rate,
               FragmentRule rule)
    : grid_(grid), material_(material), kind_(kind), loading_rate_(loading_rate), rule_(rule) {
    material_.validate();
    require(loading_rate >= 0.0 && loading_rate <= 1.0, "loading_rate", loading_rate, "between 0 and 1");
    if (kind != KernelKind::blend && loading_rate != 0.0) {
        throw ParameterError({.parameter = "loading_rate",
                              .value = text(loading_rate),
                              .number = loading_rate,
                              .rule = "a rate belongs to the blend of kernels, and this one is no blend",
                              .remedy = Remedy::use_blend_kernel});
    }
    fragments_ = fragment_pmf(material_.fragments, grid_.spacing(), grid_.bins(), rule);
}

CrushShares Kernel::shares(Zone zone, Index i, Index j) const {
    if (kind_ == KernelKind::fast) return {0.0, 0.0, 1.0};
    if (kind_ == KernelKind::exact) {
        if (zone == Zone::both) return {0.0, 0.0, 1.0};
        return zone == Zone::grain ? CrushShares{1.0, 0.0, 0.0} : CrushShares{0.0, 1.0, 0.0};
    }
    const double slow = 1.0 - loading_rate_;
    if (i == j) return {0.5 * slow, 0.5 * slow, loading_rate_};
    return i > j ? CrushShares{slow, 0.0, loading_rate_} : CrushShares{0.0, slow, loading_rate_};
}

void Kernel::cell(Index i, Index j, double stress_ratio, MatrixView<double> out) const {
    const Index bins = grid_.bins();
    require_square(out, bins, "out");
    require(i >= 0 && i < bins, "i", static_cast<double>(i), "a bin of the grid, 0 to bins - 1");
    require(j >= 0 && j < bins, "j", static_cast<double>(j), "a bin of the grid, 0 to bins - 1");
    const Zone zone = CrushZones(grid_, material_, stress_ratio).at(i, j);
    for (Index row = 0; row < bins; ++row) std::fill_n(out.row(row), bins, 0.0);
    if (zone == Zone::rest) {
        out(i, j) = 1.0;
        return;
    }
    const CrushShares share = shares(zone, i, j);
    const std::vector<double> down_i = spread(fragments_, i);
    const std::vector<double> down_j = spread(fragments_, j);
    for (Index row = 0; row <= i; ++row) {
        const double along_i = down_i[static_cast<std::size_t>(row)];
        for (Index col = 0; col <= j; ++col) {
            out(row, col) = share.both * along_i * down_j[static_cast<std::size_t>(col)];
        }
        out(row, j) += share.grain * along_i;
    }
    for (Index col = 0; col <= j; ++col) {
        out(i, col) += share.neighbour * down_j[static_cast<std::size_t>(col)];
    }
}

}  // namespace comminute
