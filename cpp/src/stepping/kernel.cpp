// SPDX-License-Identifier: BSD-3-Clause
// The crushing kernel: which grain of an active cell crushes, and where its mass goes (docs/theory/one_sweep.md,
// section 13).
#include "comminute/kernel.hpp"

#include <algorithm>

#include "base/arrays.hpp"
#include "base/check.hpp"

namespace comminute {

using namespace detail;

namespace {

// (N) place of one unit of mass in bin `from` of a line after one crush.
Array<double> spread(const FragmentPmf& fragments, Index from) {
    const VectorView<const double> mass = fragments.mass;
    Array<double> line(mass.size());
    for (Index m = 0; m < from; ++m) line[from - m] = mass[m];
    line[0] = at(fragments.below, from);
    return line;
}

}  // namespace

Kernel::Kernel(const LogGrid& grid, const Material& material, const KernelOptions& options)
    : grid_(grid), material_(material), options_(options) {
    material_.validate_sharp();
    const auto& [kind, loading_rate, scheme] = options_;
    require(loading_rate >= 0.0 && loading_rate <= 1.0, "loading_rate", loading_rate, "between 0 and 1");
    if (kind != KernelKind::blend && loading_rate != 0.0) {
        throw ParameterError({.parameter = "loading_rate",
                              .value = text(loading_rate),
                              .number = loading_rate,
                              .rule = "a rate belongs to the blend of kernels, and this one is no blend",
                              .remedy = Remedy::use_blend_kernel});
    }
    fragments_ = fragment_pmf(material_.fragments, grid_.spacing(), grid_.bins(), scheme);
}

CrushShares Kernel::shares(Zone zone, Index i, Index j) const {
    const KernelKind kind = options_.kind;
    const double fast_share = options_.loading_rate;
    if (kind == KernelKind::fast) return {0.0, 0.0, 1.0};
    if (kind == KernelKind::exact) {
        if (zone == Zone::both) return {0.0, 0.0, 1.0};
        return zone == Zone::grain ? CrushShares{1.0, 0.0, 0.0} : CrushShares{0.0, 1.0, 0.0};
    }
    const double slow = 1.0 - fast_share;
    if (i == j) return {0.5 * slow, 0.5 * slow, fast_share};
    return i > j ? CrushShares{slow, 0.0, fast_share} : CrushShares{0.0, slow, fast_share};
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
    const Array<double> down_i = spread(fragments_, i);
    const Array<double> down_j = spread(fragments_, j);
    for (Index row = 0; row <= i; ++row) {
        for (Index col = 0; col <= j; ++col) out(row, col) = share.both * down_i[row] * down_j[col];
        out(row, j) += share.grain * down_i[row];
    }
    for (Index col = 0; col <= j; ++col) out(i, col) += share.neighbour * down_j[col];
}

}  // namespace comminute
