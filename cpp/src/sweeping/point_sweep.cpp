// SPDX-License-Identifier: BSD-3-Clause
#include "sweeping/point_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "zones/shell_zone.hpp"

namespace comminute::detail {
namespace {

constexpr std::size_t most_sizes_kept = 256;  // many more are of many fabrics, not of one

Axis other(Axis axis) {
    return axis == Axis::grain ? Axis::neighbour : Axis::grain;
}

double overlap(double from, double to, double zone_from, double zone_to) {
    if (!(to > from)) return 0.0;
    return std::clamp((std::min(to, zone_to) - std::max(from, zone_from)) / (to - from), 0.0, 1.0);
}

// Of what settled, which fills the part outside the old zone, the share that a larger zone moves.
double newly(double before, double after) {
    return before < 1.0 ? std::max(after - before, 0.0) / (1.0 - before) : 0.0;
}

// Equal but for rounding: either grain may be the first to crush.
bool equal_sizes(double a, double b) {
    return std::abs(a - b) <=
           8.0 * std::numeric_limits<double>::epsilon() * std::max({1.0, std::abs(a), std::abs(b)});
}

}  // namespace

PointSweep::PointSweep(const LogGrid& grid, const Material& material, FragmentPmf fragments, double rate)
    : grid_(grid),
      material_(material),
      fragments_(std::move(fragments)),
      rate_(rate),
      before_(grid, material, 0.0),
      after_(grid, material, 0.0) {}

// Probability that a fragment of an exact size ends below psi.
double PointSweep::finer(double psi, double than_fragment_of) const {
    const double r = std::min(psi - than_fragment_of, 0.0);
    return std::visit([r](const auto& law) { return law.cdf(r); }, material_.fragments);
}

// (N) where the fragments of one exact size land; the fines bin takes all below it.
const std::vector<double>& PointSweep::fragments_of(double at) {
    std::vector<double>& pmf = fragments_of_[at];
    if (!pmf.empty()) return pmf;
    pmf.resize(static_cast<std::size_t>(grid_.bins()));
    double below = 0.0;
    for (Index i = 0; i < grid_.bins(); ++i) {
        const double finer_than = finer(grid_.edge(i + 1), at);
        pmf[static_cast<std::size_t>(i)] = finer_than - below;
        below = finer_than;
    }
    return pmf;
}

PointSweep::Line& PointSweep::line(Axis exact, double at) {
    Line& found = lines_[{exact, at}];
    found.settled.resize(static_cast<std::size_t>(grid_.bins()));
    found.arrived.resize(static_cast<std::size_t>(grid_.bins()));
    return found;
}

std::vector<double>& PointSweep::into_bins(Axis exact, double at) {
    std::vector<double>& bins = into_bins_[{exact, at}];
    bins.resize(static_cast<std::size_t>(grid_.bins()));
    return bins;
}

void PointSweep::crush_atom(const Atom& atom) {
    const double grain = equal_sizes(atom.psi, atom.psibar) ? 0.5 : (atom.psi > atom.psibar ? 1.0 : 0.0);
    const auto onto_ridge = [&](Axis exact, double at, double from, double mass) {
        if (mass == 0.0) return;
        Line& ridge = line(exact, at);
        const std::vector<double>& pmf = fragments_of(from);
        const Index own = grid_.bin_of(at);
        const double within = finer(grid_.edge(own + 1), from) - finer(at, from);
        for (Index i = 0; i < grid_.bins(); ++i) {
            Parts& landed = ridge.arrived[static_cast<std::size_t>(i)];
            const double share = pmf[static_cast<std::size_t>(i)];
            const double above = i < own ? 0.0 : (i > own ? share : std::clamp(within, 0.0, share));
            landed.above += mass * above;
            landed.below += mass * (share - above);
        }
    };
    const double slow = (1.0 - rate_) * atom.mass;
    onto_ridge(Axis::neighbour, atom.psibar, atom.psi, slow * grain);
    onto_ridge(Axis::grain, atom.psi, atom.psibar, slow * (1.0 - grain));
    const double fast = rate_ * atom.mass;
    count(Axis::grain, slow * grain + fast);
    count(Axis::neighbour, slow * (1.0 - grain) + fast);
    if (fast == 0.0) return;
    const std::vector<double>& pmf = fragments_of(atom.psibar);
    std::vector<double>& partners = into_bins(Axis::grain, atom.psi);
    for (std::size_t j = 0; j < pmf.size(); ++j) partners[j] += fast * pmf[j];
}

// What crushes along a ridge until it leaves its bin; in the bin that holds the exact size it lands on both sides.
void PointSweep::fall_along(double mass, Index from, double at, std::vector<Parts>& onto) const {
    const Index own = grid_.bin_of(at);
    // On an edge, rounding may take it out of its bin by an ulp.
    const double upper_part = std::clamp((grid_.edge(own + 1) - at) / grid_.spacing(), 0.0, 1.0);
    const double leaves = fragments_.below[1];
    for (Index k = 0; k < from; ++k) {
        const double share = k == 0 ? fragments_.below[static_cast<std::size_t>(from)]
                                    : fragments_.mass[static_cast<std::size_t>(from - k)];
        const double landed = mass * share / leaves;
        const double above = k < own ? 0.0 : (k > own ? landed : landed * upper_part);
        onto[static_cast<std::size_t>(k)].above += above;
        onto[static_cast<std::size_t>(k)].below += landed - above;
    }
}

// One crush, of which some stays in the bin.
void PointSweep::spread(double mass, Index from, std::vector<double>& onto) const {
    if (from == 0) {
        onto[0] += mass;
        return;
    }
    for (Index k = 1; k <= from; ++k) {
        onto[static_cast<std::size_t>(k)] += mass * fragments_.mass[static_cast<std::size_t>(from - k)];
    }
    onto[0] += mass * fragments_.below[static_cast<std::size_t>(from)];
}

// Below the exact size the zone reaches as far as its half-width there, W; above it, where the partner is the larger
// one, to the roots of D^2 = W^2 + k D.
PointSweep::Reach PointSweep::reach(const CrushZones& zones, double at) const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Reach zone{infinity, -infinity, infinity, -infinity};  // nowhere
    const double width = zones.half_width(at);
    if (width >= 0.0) {
        zone.below_from = at - width;
        zone.below_to = at;
    }
    const double k = material_.k();
    const double tip = zone_onset(material_, std::log(zones.stress_ratio()));
    if (std::isinf(k)) {
        zone.above_from = tip;
        zone.above_to = infinity;
        return zone;
    }
    const double square = k * (at - tip);
    const double discriminant = 0.25 * k * k + square;
    if (!(discriminant >= 0.0)) return zone;
    const double far = 0.5 * k + std::sqrt(discriminant);
    zone.above_from = at + (square < 0.0 ? -square / far : 0.0);
    zone.above_to = at + far;
    return zone;
}

// Shares of the two parts of a bin that lie in the zone.
PointSweep::Parts PointSweep::active(const Reach& zone, double at, Index bin) const {
    const double from = grid_.edge(bin);
    const double to = grid_.edge(bin + 1);
    return {overlap(from, std::min(to, at), zone.below_from, zone.below_to),
            overlap(std::max(from, at), to, zone.above_from, zone.above_to)};
}

void PointSweep::crush_line(const Place& place, Line& ridge) {
    const auto [exact, at] = place;
    const Reach zone_before = reach(before_, at);
    const Reach zone_after = reach(after_, at);
    for (Index j = grid_.bins() - 1; j >= 0; --j) {
        Parts& settled = ridge.settled[static_cast<std::size_t>(j)];
        const Parts arrived = ridge.arrived[static_cast<std::size_t>(j)];
        if (settled.below + settled.above + arrived.below + arrived.above == 0.0) continue;
        const Parts was = active(zone_before, at, j);
        Parts share = active(zone_after, at, j);
        share = {std::max(share.below, was.below), std::max(share.above, was.above)};
        const Parts fresh{newly(was.below, share.below), newly(was.above, share.above)};
        const double above = settled.above * fresh.above + arrived.above * share.above;
        const double below = settled.below * fresh.below + arrived.below * share.below;
        settled.above = settled.above * (1.0 - fresh.above) + arrived.above * (1.0 - share.above);
        settled.below = settled.below * (1.0 - fresh.below) + arrived.below * (1.0 - share.below);
        if (above > 0.0) {  // the partner is the larger one
            const double leaves = fragments_.below[1];
            const double crushing = above / (rate_ + (1.0 - rate_) * leaves);
            const double slow = (1.0 - rate_) * crushing;
            fall_along(slow * leaves, j, at, ridge.arrived);
            count(other(exact), crushing);
            count(exact, rate_ * crushing);
            if (rate_ > 0.0) spread(rate_ * crushing, j, into_bins(exact, at));
        }
        if (below > 0.0) {
            std::vector<double>& partners = into_bins(exact, at);
            partners[static_cast<std::size_t>(j)] += (1.0 - rate_) * below;
            count(exact, below);
            count(other(exact), rate_ * below);
            if (rate_ > 0.0) spread(rate_ * below, j, partners);
        }
    }
}

void PointSweep::run(const Fabric& state, double stress_ratio) {
    atoms_.clear();
    lines_.clear();
    into_bins_.clear();
    crushed_[0] = crushed_[1] = 0.0;
    if (state.atoms().empty() && state.ridges().empty()) return;
    if (fragments_of_.size() > most_sizes_kept) fragments_of_.clear();
    const double settled = state.settled_at().value_or(0.0);
    if (before_.stress_ratio() != settled) before_.set_load(settled);
    if (after_.stress_ratio() != stress_ratio) after_.set_load(stress_ratio);
    for (const Ridge& ridge : state.ridges()) {
        Line& onto = line(ridge.exact, ridge.at);
        const Index own = grid_.bin_of(ridge.at);
        for (Index j = 0; j < grid_.bins(); ++j) {
            const double mass = ridge.mass[static_cast<std::size_t>(j)];
            const double above = j < own ? 0.0 : (j > own ? mass : ridge.above);
            Parts& there = onto.settled[static_cast<std::size_t>(j)];
            there.above += above;
            there.below += mass - above;
        }
    }
    for (const Atom& atom : state.atoms()) {
        if (after_.active(atom.psi, atom.psibar)) {
            crush_atom(atom);
        } else {
            atoms_.push_back(atom);
        }
    }
    for (auto& [place, ridge] : lines_) crush_line(place, ridge);
}

std::vector<Ridge> PointSweep::ridges() const {
    std::vector<Ridge> left;
    for (const auto& [place, line] : lines_) {
        Ridge ridge{place.first, place.second, {}, 0.0};
        double total = 0.0;
        for (const Parts& there : line.settled) {
            ridge.mass.push_back(there.below + there.above);
            total += ridge.mass.back();
        }
        ridge.above = line.settled[static_cast<std::size_t>(grid_.bin_of(ridge.at))].above;
        if (total > 0.0) left.push_back(std::move(ridge));
    }
    return left;
}

std::vector<OuterProduct> PointSweep::arrivals() {
    std::vector<OuterProduct> products;
    for (const auto& [place, partners] : into_bins_) {
        const std::vector<double>& pmf = fragments_of(place.second);
        if (place.first == Axis::grain) {
            products.push_back({pmf, partners});
        } else {
            products.push_back({partners, pmf});
        }
    }
    return products;
}

}  // namespace comminute::detail
