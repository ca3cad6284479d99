// SPDX-License-Identifier: BSD-3-Clause
// Tables of the three-cell law (docs/theory/three_cells.md, sections 2 and 3).
#include "resolved/triple_tables.hpp"

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "base/check.hpp"
#include "base/gauss.hpp"

namespace comminute::detail {

namespace {

constexpr double edge_floor = 0.01;  // least width of a zone's edge, in fabric widths
constexpr double tie_rise = 0.001;   // of ln(stress ratio), in which tied cells crush in random order
constexpr double tie_slack = 0.05;   // fabric widths by which a tie may be active beyond the zone's edge
constexpr int most_panels = 64;
constexpr double least_share = 1e-18;  // of scattered strengths within the reach, rounding of any mass

// Mean over a bin of the share of fragments no larger than `size`; of an exact size, at it.
template <class Law>
double mean_cdf(const Law& law, double lower, double upper, double size) {
    const auto cdf = [&](double psi) { return law.cdf(std::min(size - psi, 0.0)); };
    if (lower == upper) return cdf(lower);
    if (size >= upper) return 1.0;
    std::vector<double> ends{lower};
    if (size > lower) ends.push_back(size);
    if constexpr (requires { law.kinks(); }) {
        for (const double r : law.kinks()) {
            if (size - r > lower && size - r < upper) ends.push_back(size - r);
        }
    }
    ends.push_back(upper);
    std::sort(ends.begin(), ends.end());
    double sum = 0.0;
    for (std::size_t k = 1; k < ends.size(); ++k) {
        const double panels = std::ceil((ends[k] - ends[k - 1]) / law.smooth_length());
        sum += integrate(cdf, ends[k - 1], ends[k],
                         static_cast<int>(std::clamp(panels, 1.0, 1.0 * most_panels)));
    }
    return sum / (upper - lower);
}

double ramp(double y) {
    return std::clamp(y + 0.5, 0.0, 1.0);
}

}  // namespace

TripleTables::TripleTables(const ResolvedGrid& grid, const Material& material, Mean mean)
    : grid_(grid),
      material_(material),
      mean_(mean),
      nodes_(grid.nodes()),
      stride_(row_stride(nodes_)),
      strength_(nodes_),
      centre_(nodes_),
      width_(nodes_),
      widest_(nodes_),
      mean_size_(nodes_ * stride_),
      spread_(nodes_ * stride_),
      fragments_(nodes_ * stride_) {
    material_.validate();
    const double n = material_.fabric_width;
    require(std::isfinite(n), "fabric_width", n,
            "finite for the law of three cells, whose zone it is the width of");
    floor_ = edge_floor * n * edge_floor * n;
    tie_length_ = 2.0 * n * n * tie_rise;
    tie_slack_ = tie_slack * n;
    early_ = material_.strength_scatter ? -least_log_hazard * 2.0 * n * n / material_.weibull_modulus : 0.0;
    contrast_ = std::sqrt(material_.weibull_modulus) / n;
    const double reference = std::log(material_.reference_size);
    for (Index i = 0; i < nodes_; ++i) {
        centre_[i] = grid.centre(i);
        width_[i] = grid.width(i);
        strength_[i] = material_.k() * (centre_[i] - reference);
    }
    lowest_level_ = -material_.k() * (grid.upper(nodes_ - 1) - reference) - 2.0 * tie_length_ - early_;
    for (Index a = 0; a < nodes_; ++a) {
        for (Index c = 0; c <= a; ++c) {
            const double ratio = std::exp(centre_[c] - centre_[a]);
            const bool sizes = mean_ == Mean::arithmetic;
            const double of_a = sizes ? 1.0 / (1.0 + ratio) : 0.5;
            const double size =
                sizes ? centre_[a] + std::log(0.5 * (1.0 + ratio)) : 0.5 * (centre_[a] + centre_[c]);
            const double x = of_a * width_[a];
            const double y = (1.0 - of_a) * width_[c];
            mean_size_[a * stride_ + c] = mean_size_[c * stride_ + a] = size;
            spread_[a * stride_ + c] = spread_[c * stride_ + a] = x * x + y * y;
            widest_[a] = std::max(widest_[a], x * x + y * y);
            widest_[c] = std::max(widest_[c], x * x + y * y);
        }
    }
    set_fragments();
}

void TripleTables::set_fragments() {
    std::visit(
        [&](const auto& law) {
            for (Index b = 0; b < nodes_; ++b) {
                double* row = fragments_.data() + b * stride_;
                double below = 1.0;
                for (Index i = b; i > 0; --i) {
                    if (grid_.exact(i)) continue;
                    const double finer = mean_cdf(law, grid_.lower(b), grid_.upper(b), grid_.lower(i));
                    row[i] = below - finer;
                    below = finer;
                }
                row[0] = below;
            }
        },
        material_.fragments);
}

double TripleTables::level(double log_stress_ratio) const {
    return 2.0 * material_.fabric_width * material_.fabric_width * log_stress_ratio;
}

double TripleTables::log_stress_ratio(double level) const {
    return level / (2.0 * material_.fabric_width * material_.fabric_width);
}

CentreZone TripleTables::zone(Index b, double level) const {
    if (b == 0) return {};
    const double early = grid_.exact(b) ? tie_length_ : 0.0;  // ties begin before the zone reaches them
    CentreZone zone{std::sqrt(std::max(level + early + early_ + strength_[b], 0.0)), std::nullopt};
    // In scattered units the square of a zone's half-width, without what is early, is twice the log of the hazard.
    if (material_.strength_scatter && zone.half_width > 0.0)
        zone.scattered.emplace(0.5 * contrast_ * contrast_ * (level + strength_[b]));
    return zone;
}

double TripleTables::tie(Index b, Index a, Index c, double level) const {
    const double x = centre_[b] - neighbourhood(a, c);
    return std::clamp(1.0 + (level - (x * x - strength_[b])) / tie_length_, 0.0, 1.0);
}

double TripleTables::share(Index b, Index a, Index c, double level, const CentreZone& zone) const {
    double half_width = zone.half_width;
    if (half_width == 0.0) return 0.0;
    const double x = centre_[b] - neighbourhood(a, c);
    const double edge = std::sqrt(width_[b] * width_[b] + spread(a, c) + floor_);
    if (zone.scattered) {
        // Beyond the reach of either neighbour there is nothing and within it something, so that both find the same and the
        // reach is nested in the load, whatever the rounding.
        if (2.0 * (std::abs(x) - half_width) >= edge) return 0.0;
        const double found = all_exact(b, a, c) ? zone.scattered->at(contrast_ * x)
                                                : zone.scattered->mean(contrast_ * (x - 0.5 * edge),
                                                                       contrast_ * (x + 0.5 * edge));
        return std::max(found, least_share);
    }
    if (grid_.exact(b)) {
        if (all_exact(b, a, c)) return tie(b, a, c, level);
        half_width = std::sqrt(std::max(level + strength_[b], 0.0));
        if (half_width == 0.0) return 0.0;
    }
    return ramp((half_width - x) / edge) - ramp((-half_width - x) / edge);
}

double TripleTables::endured(Index b, Index a, Index c, const CentreZone& zone, double share) const {
    if (all_exact(b, a, c)) return hazard_of(share);
    const double x = centre_[b] - neighbourhood(a, c);
    const double edge = std::sqrt(width_[b] * width_[b] + spread(a, c) + floor_);
    return zone.scattered->endured(contrast_ * (x - 0.5 * edge), contrast_ * (x + 0.5 * edge), share);
}

Reach TripleTables::reach(Index b, Index a, double level, const CentreZone& zone) const {
    if (zone.half_width == 0.0) return {};
    const double most =
        zone.half_width + 0.5 * std::sqrt(width_[b] * width_[b] + widest_[a] + floor_) + tie_slack_;
    const double* means = mean_size_.data() + a * stride_;
    const double* begin = std::lower_bound(means, means + nodes_, centre_[b] - most);
    const double* end = std::upper_bound(begin, means + nodes_, centre_[b] + most);
    Reach found{begin - means, end - means - 1};
    const auto outside = [&](Index c) {
        const double beyond = std::abs(centre_[b] - means[c]) - zone.half_width - tie_slack_;
        return beyond > 0.0 && 4.0 * beyond * beyond >= width_[b] * width_[b] + spread(a, c) + floor_;
    };
    while (!found.empty() && outside(found.first)) ++found.first;
    while (!found.empty() && outside(found.last)) --found.last;
    while (!found.empty() && share(b, a, found.first, level, zone) == 0.0) ++found.first;
    while (!found.empty() && share(b, a, found.last, level, zone) == 0.0) --found.last;
    return found;
}

}  // namespace comminute::detail
