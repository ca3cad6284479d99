// SPDX-License-Identifier: BSD-3-Clause
// The paper's fabric of a law of three cells (docs/theory/three_cells.md, section 2).
#include "resolved/triple_joint.hpp"

#include <algorithm>
#include <cmath>

#include "base/check.hpp"

namespace comminute::detail {

namespace {

/// Shares of a piece of log size in the bins of a grid: the first bin, and one share each from there on.
struct Shares {
    Index first;
    std::vector<double> share;
};

Shares shares_of(const LogGrid& grid, double lower, double upper) {
    if (upper <= lower) return {grid.bin_of(upper), {1.0}};
    const double begin = (lower - grid.psi_min()) / grid.spacing() + 0.5;
    const double end = (upper - grid.psi_min()) / grid.spacing() + 0.5;
    const auto bin = [&](double place) {
        return std::clamp<Index>(static_cast<Index>(std::floor(place)), 0, grid.bins() - 1);
    };
    Shares found{bin(begin), {}};
    double below = 0.0;
    for (Index i = found.first; i <= bin(end); ++i) {
        const double edge = std::min(static_cast<double>(i + 1), end);
        const double finer = i == bin(end) ? 1.0 : std::max(edge - begin, 0.0) / (end - begin);
        found.share.push_back(finer - below);
        below = finer;
    }
    return found;
}

}  // namespace

std::vector<double> joint_of(const TripleTables& tables, const LogGrid& bins,
                             const std::function<double(Index, Index, Index)>& mass_of) {
    const ResolvedGrid& nodes = tables.grid();
    const double top = nodes.upper(nodes.nodes() - 1);
    const double end = bins.centre(bins.bins() - 1) + 0.5 * bins.spacing();
    if (top > end + 1e-9 * bins.spacing()) {  // an end that is the largest grain's up to rounding holds it
        throw ParameterError({.parameter = "grid",
                              .value = text(end),
                              .number = end,
                              .subject = "the grid",
                              .finding = "ends at " + text(end),
                              .rule = "the largest grain has a log size of " + text(top),
                              .remedy = Remedy::raise_psi_max});
    }
    Array<double> joint(bins.bins() * bins.bins());
    Array<double> line(bins.bins());
    for (Index b = 0; b < nodes.nodes(); ++b) {
        std::fill(line.begin(), line.end(), 0.0);
        for (Index a = 0; a < nodes.nodes(); ++a) {
            for (Index c = 0; c < nodes.nodes(); ++c) {
                const double mass = mass_of(b, a, c);
                const double half = 0.5 * std::sqrt(tables.spread(a, c));
                const double middle = tables.neighbourhood(a, c);
                const Shares of = shares_of(bins, middle - half, std::min(middle + half, top));
                for (std::size_t k = 0; k < of.share.size(); ++k)
                    line[of.first + static_cast<Index>(k)] += mass * of.share[k];
            }
        }
        const Shares of = shares_of(bins, nodes.lower(b), nodes.upper(b));
        for (std::size_t k = 0; k < of.share.size(); ++k) {
            double* row = joint.data() + (of.first + static_cast<Index>(k)) * bins.bins();
            for (Index j = 0; j < bins.bins(); ++j) row[j] += of.share[k] * line[j];
        }
    }
    return std::move(joint).vector();
}

}  // namespace comminute::detail
