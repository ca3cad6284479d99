// SPDX-License-Identifier: BSD-3-Clause
// Nodes of the resolved continuum: their widths, and the mass of a grading in them (docs/theory/three_cells.md, section 2).
#include "comminute/resolved_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include "base/check.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr double fines_width = 2.0;       // of the fines bin, whose centre is its size as a neighbour
constexpr double least_range = 8.0;       // between the largest grain and the fines bin, in ln(size)
constexpr double below_the_start = 1.0;   // between the start and the fines bin
constexpr double same_size = 1e-12;       // rounding of the log of an exact size
constexpr double same_edge = 1e-9;        // distance in ln(size) of two edges that are one
constexpr double negligible_tail = 3e-7;  // share of a spread without a bound beyond five standard deviations

/// Bins that go down from one anchor to the next.
class Descent {
  public:
    Descent(double fabric_width, const std::vector<Support>& supports, const NodeOptions& options)
        : near_(options.grade * fabric_width), supports_(supports), options_(options) {}

    /// Appends the lower ends of the bins from `top` down to `bottom`, which is the last of them.
    void append(double top, double bottom, std::vector<double>& edges) const {
        const double most = widest(top, bottom);
        double edge = top;
        while (true) {
            const double width = std::min(most, std::max(std::min(most, near_), 0.5 * (top - edge)));
            if (edge - bottom < 1.5 * width) break;
            edge -= width;
            edges.push_back(edge);
        }
        edges.push_back(bottom);
    }

  private:
    double widest(double top, double bottom) const {
        double most = options_.spacing;
        for (const Support& support : supports_) {
            if (support.upper < top || support.lower > bottom) continue;
            most =
                std::min(most, (support.upper - support.lower) / static_cast<double>(options_.support_bins));
        }
        return most;
    }

    double near_;
    const std::vector<Support>& supports_;
    const NodeOptions& options_;
};

void sort_once(std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

[[noreturn]] void refuse_order(const char* list, std::size_t i, double value, const std::string& rule) {
    throw ParameterError(
        {.parameter = list, .value = text(value), .number = value, .rule = rule, .place = {entry(list, i)}});
}

}  // namespace

ResolvedGrid::ResolvedGrid(std::vector<double> lower, std::vector<double> upper)
    : lower_(std::move(lower)), upper_(std::move(upper)) {
    require_entries(static_cast<Index>(upper_.size()), nodes(), entry("upper"), "lower has as many as nodes");
    if (nodes() < 3) {
        throw ShapeError({.parameter = "lower",
                          .value = std::to_string(nodes()),
                          .number = static_cast<double>(nodes()),
                          .finding = "has " + std::to_string(nodes()) + " entries",
                          .rule = "it must have at least 3, the fines bin and two nodes"});
    }
    for (std::size_t i = 0; i < lower_.size(); ++i) {
        if (!std::isfinite(lower_[i])) refuse_order("lower", i, lower_[i], "it must be finite");
        if (!std::isfinite(upper_[i]) || upper_[i] < lower_[i] || (i == 0 && upper_[i] == lower_[i])) {
            refuse_order("upper", i, upper_[i], "it must not be below lower, and above it for the fines bin");
        }
        if (i == 0) continue;
        if (lower_[i] != upper_[i - 1]) {
            refuse_order("lower", i, lower_[i],
                         "it must be where the node before ends, at " + text(upper_[i - 1]));
        }
        if (exact(static_cast<Index>(i)) && exact(static_cast<Index>(i - 1)))
            refuse_order("lower", i, lower_[i], "it must not be the exact size before it again");
    }
}

ResolvedGrid ResolvedGrid::graded(double fabric_width, double bottom, std::vector<double> exact,
                                  const std::vector<Support>& supports, const NodeOptions& options,
                                  const std::vector<double>& edges) {
    require(fabric_width > 0.0 && std::isfinite(fabric_width), "fabric_width", fabric_width,
            "greater than 0 and finite");
    require(options.spacing > 0.0, "spacing", options.spacing, "greater than 0");
    require(options.grade > 0.0, "grade", options.grade, "greater than 0");
    require(options.support_bins >= 1, "support_bins", static_cast<double>(options.support_bins),
            "at least 1");
    std::vector<double> anchors = exact;
    for (const Support& support : supports) {
        require(support.lower < support.upper, "lower", support.lower, "below the upper end of its support");
        anchors.insert(anchors.end(), {support.lower, support.upper});
    }
    sort_once(exact);
    sort_once(anchors);
    require(!anchors.empty() && std::isfinite(bottom) && bottom < anchors.front(), "bottom", bottom,
            "below every size of the start");

    std::vector<double> falling{anchors.back()};
    const Descent descent(fabric_width, supports, options);
    for (auto anchor = anchors.rbegin(); anchor != anchors.rend(); ++anchor) {
        const bool last = anchor + 1 == anchors.rend();
        descent.append(*anchor, last ? bottom : *(anchor + 1), falling);
    }
    const auto bins_end = static_cast<std::ptrdiff_t>(falling.size());
    for (const double edge : edges) {
        const auto there = [edge](double other) { return std::abs(edge - other) < same_edge; };
        if (edge < bottom || edge > anchors.back()) continue;
        if (std::none_of(falling.begin(), falling.begin() + bins_end, there)) falling.push_back(edge);
    }
    sort_once(falling);

    std::vector<double> lower{bottom - fines_width};
    std::vector<double> upper{bottom};
    auto next = exact.begin();
    for (std::size_t k = 1; k < falling.size(); ++k) {
        lower.push_back(falling[k - 1]);
        upper.push_back(falling[k]);
        if (next != exact.end() && *next == falling[k]) {
            lower.push_back(falling[k]);
            upper.push_back(falling[k]);
            ++next;
        }
    }
    return {std::move(lower), std::move(upper)};
}

Index ResolvedGrid::bins() const {
    Index count = 0;
    for (Index i = 0; i < nodes(); ++i) count += exact(i) ? 0 : 1;
    return count;
}

std::vector<double> ResolvedGrid::edges() const {
    std::vector<double> edges{lower_.front()};
    for (Index i = 0; i < nodes(); ++i) {
        if (!exact(i)) edges.push_back(upper(i));
    }
    return edges;
}

Index ResolvedGrid::node_of(double psi) const {
    if (!(psi <= upper_.back() + same_size)) {
        throw ParameterError({.parameter = "psi",
                              .value = text(psi),
                              .number = psi,
                              .rule = "the nodes end at " + text(upper_.back())});
    }
    for (Index i = nodes() - 1; i > 0; --i) {
        if (exact(i) ? std::abs(psi - lower(i)) <= same_size : psi > lower(i) + same_size) return i;
    }
    return 0;
}

std::vector<double> node_pmf(const Grading& grading, const ResolvedGrid& grid) {
    const Index last = grid.nodes() - 1;
    const double top = std::log(grading.largest());
    if (top > grid.upper(last)) {
        throw ParameterError({.parameter = "grading",
                              .value = text(grading.largest()),
                              .number = grading.largest(),
                              .subject = "the largest grain",
                              .rule = "the nodes end at " + text(std::exp(grid.upper(last)))});
    }
    std::vector<double> pmf(static_cast<std::size_t>(grid.nodes()), 0.0);
    if (const auto* points = std::get_if<PointMasses>(&grading.law)) {
        for (std::size_t k = 0; k < points->size.size(); ++k) {
            pmf[static_cast<std::size_t>(grid.node_of(std::log(points->size[k])))] += points->share[k];
        }
        return pmf;
    }
    double below = 0.0;
    for (Index i = 0; i <= last; ++i) {
        if (i > 0 && grid.exact(i)) continue;
        const double finer = i == last || grid.upper(i) >= top ? 1.0 : grading.finer(std::exp(grid.upper(i)));
        pmf[static_cast<std::size_t>(i)] = std::max(finer - below, 0.0);
        below = std::max(finer, below);
    }
    return pmf;
}

ResolvedGrid fitting_nodes(const Grading& grading, double fabric_width, const NodeOptions& options,
                           const std::vector<double>& edges) {
    return fitting_nodes(std::vector<Grading>{grading}, fabric_width, options, edges);
}

ResolvedGrid fitting_nodes(const std::vector<Grading>& gradings, double fabric_width,
                           const NodeOptions& options, const std::vector<double>& edges) {
    require(!gradings.empty(), "gradings", 0.0, "at least one");
    double bottom = std::numeric_limits<double>::infinity();
    for (const double edge : edges) {
        require(std::isfinite(edge), "edges", edge, "finite");
        bottom = std::min(bottom, edge);
    }
    std::vector<double> exact;
    std::vector<double> ends = edges;
    std::vector<Support> supports;
    for (const Grading& grading : gradings) {
        const double top = std::log(grading.largest());
        bottom = std::min(bottom, top - least_range);
        if (const auto* points = std::get_if<PointMasses>(&grading.law)) {
            for (const double size : points->size) exact.push_back(std::log(size));
            bottom = std::min(bottom, std::log(points->size.front()) - below_the_start);
            continue;
        }
        double lowest = 0.0;
        if (const auto* sieves = std::get_if<SieveCurve>(&grading.law)) {
            for (const double size : sieves->size) ends.push_back(std::log(size));
            lowest = std::log(sieves->size.front());
        } else {
            lowest = std::log(std::max(grading.smallest(), grading.smallest(negligible_tail)));
        }
        bottom =
            std::min({bottom, lowest - below_the_start, std::log(grading.smallest(1e-3)) - below_the_start});
        supports.push_back({lowest, top});
    }
    std::sort(exact.begin(), exact.end());
    exact.erase(std::unique(exact.begin(), exact.end()), exact.end());
    return ResolvedGrid::graded(fabric_width, bottom, exact, supports, options, ends);
}

ResolvedGrid fitting_nodes(VectorView<const double> psi, const std::vector<PointMass>& exact,
                           double fabric_width, const NodeOptions& options) {
    require(psi.size() >= 1, "cells", static_cast<double>(psi.size()), "at least 1");
    std::vector<double> sizes(psi.begin(), psi.end());
    std::sort(sizes.begin(), sizes.end());
    const double top = sizes.back();
    const double lowest = sizes[sizes.size() / 1000];
    std::vector<double> points;
    points.reserve(exact.size());
    for (const PointMass& point : exact) points.push_back(point.psi);
    const auto is_exact = [&](double size) {
        const auto same = [size](double other) { return std::abs(size - other) <= same_size; };
        return std::any_of(points.begin(), points.end(), same);
    };
    sizes.erase(std::remove_if(sizes.begin(), sizes.end(), is_exact), sizes.end());
    std::vector<Support> supports;
    if (!sizes.empty() && std::max(sizes.front(), lowest) < sizes.back())
        supports.push_back({std::max(sizes.front(), lowest), sizes.back()});
    const double bottom = std::min(top - least_range, lowest - below_the_start);
    return ResolvedGrid::graded(fabric_width, bottom, points, supports, options);
}

}  // namespace comminute
