// SPDX-License-Identifier: BSD-3-Clause
// Bonds and colours, lengths and ends (docs/theory/columns.md, sections 1 and 5).
#include "columns/column_work.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "base/check.hpp"
#include "columns/shifted_exchange.hpp"

namespace comminute::detail {

Grains ColumnWork::grains_of(const std::vector<double>& pmf, const Array<double>* counts) const {
    Grains found;
    const double mass = std::accumulate(pmf.begin(), pmf.end(), 0.0);
    found.smallest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < pmf.size(); ++i) {
        found.share.push_back(std::max(pmf[i], 0.0) / mass);
        found.count.push_back(counts && pmf[i] > 0.0 ? (*counts)[static_cast<Index>(i)] / pmf[i] : 0.0);
        found.mean += found.share[i] * tables.sizes[i];
        if (!(found.share[i] > 0.0)) continue;
        found.largest = std::max(found.largest, tables.sizes[i]);
        found.smallest = std::min(found.smallest, tables.sizes[i]);
    }
    return found;
}

std::vector<double> ColumnWork::loads() const {
    std::vector<double> found;
    for (const LawRow& row : rows) found.push_back(row.load().value_or(0.0));
    return found;
}

void ColumnWork::require_ends(const ColumnEnds& ends) const {
    const Index nodes = tables.triples.nodes();
    const bool periodic = ends.bottom == ColumnEnd::periodic;
    const auto end = [](bool right, const char* rule) {
        if (!right)
            throw ParameterError({.parameter = "ends", .subject = "the ends of a column", .finding = rule});
    };
    end(periodic == (ends.top == ColumnEnd::periodic), "are both periodic, or neither");
    end(!periodic || count() % 2 == 0, "are periodic with an even number of rows only");
    const bool below = ends.bottom == ColumnEnd::feed;
    const bool above = ends.top == ColumnEnd::feed;
    end(!(below && above), "have one feed at most");
    const ColumnEnd other = below ? ends.top : ends.bottom;
    const bool outflow = ends.bottom == ColumnEnd::outflow || ends.top == ColumnEnd::outflow;
    require(ends.feed_rate >= 0.0 && std::isfinite(ends.feed_rate), "feed_rate", ends.feed_rate,
            "at least 0 and finite");
    end(!outflow || ((below || above) && other == ColumnEnd::outflow),
        "have an outflow only opposite to a feed");
    if (!(below || above)) return;
    end(ends.feed_rate == 0.0 || other == ColumnEnd::outflow,
        "need an outflow opposite to a feed that has a rate");
    require_entries(static_cast<Index>(ends.feed.size()), nodes, entry("feed"),
                    "the grid has " + std::to_string(nodes) + " nodes");
    const double total = std::accumulate(ends.feed.begin(), ends.feed.end(), 0.0);
    require_whole(total, "feed");
    end(options.partners == Partners::permuted, "have a feed only where partners are permuted");
}

std::vector<Grains> ColumnWork::grains() {
    std::vector<Grains> all;
    for (Index z = 0; z < count(); ++z) all.push_back(grains_of(row(z).pmf(tables), &row(z).law().counts));
    return all;
}

Bond ColumnWork::bond(const std::vector<Grains>& all, const Driven& driven, Index lower, double time) const {
    const Index last = count() - 1;
    const bool periodic = driven.ends.bottom == ColumnEnd::periodic;
    const auto grains = [&](Index z, ColumnEnd end) -> const Grains* {
        if (periodic) return &at(all, (z + count()) % count());
        if (z >= 0 && z <= last) return &at(all, z);
        return end == ColumnEnd::feed ? &driven.feed : nullptr;
    };
    Bond found{grains(lower, driven.ends.bottom), grains(lower + 1, driven.ends.top)};
    if (!found.lower || !found.upper) return {};
    const auto shear_of = [&](Index z) {
        return driven.drive.shear_rate[periodic ? (z + count()) % count() : std::clamp<Index>(z, 0, last)];
    };
    const double shear = 0.5 * (shear_of(lower) + shear_of(lower + 1));
    const double mean = 0.5 * (found.lower->mean + found.upper->mean);
    const double diffusivity = driven.drive.mixing + driven.drive.shear_mixing * shear * mean * mean;
    found.mixing = diffusivity * time / (dz() * dz());
    found.segregation = driven.drive.segregation * shear * time / (mean * dz());
    return found;
}

// Bond i, at place i + 1, is that of the rows i and i + 1, for i = -1 to the number of the last row.
std::vector<Bond> ColumnWork::bonds(const std::vector<Grains>& all, const Driven& driven, double time) const {
    std::vector<Bond> found;
    for (Index i = -1; i < count(); ++i) found.push_back(bond(all, driven, i, time));
    return found;
}

// A grain whose neighbours are nearer than the rows meets more new ones than come from the rows above and below.
double ColumnWork::renewal(const Grains& grains, const Driven& driven, Index z, double time) const {
    const double length = neighbour_length();
    if (length >= dz() * (1.0 - 1e-12)) return 0.0;
    const double diffusivity = driven.drive.mixing + driven.drive.shear_mixing * driven.drive.shear_rate[z] *
                                                         grains.mean * grains.mean;
    const auto walled = [](ColumnEnd end) { return end == ColumnEnd::closed || end == ColumnEnd::outflow; };
    const bool one_bond =
        (z == 0 && walled(driven.ends.bottom)) || (z == count() - 1 && walled(driven.ends.top));
    const double by_rows = 1.0 / (dz() * dz());
    const double missing = one_bond ? 2.0 / (length * length) - 1.0 / (length * dz()) - by_rows
                                    : 2.0 * (1.0 / (length * length) - by_rows);
    return 0.5 * diffusivity * time * missing;  // in each of the two colours
}

double ColumnWork::divided(const Driven& driven, double time, ResolvedColumnReport& report) {
    const std::vector<Grains> all = grains();
    double parts = 1.0;
    for (const Bond& b : bonds(all, driven, time)) {
        if (!b.lower) continue;
        parts = std::max({parts, b.mixing / options.largest_mixing,
                          b.largest_segregation() / options.largest_segregation});
    }
    double most = 0.0;  // of all bonds, whose probabilities are below their Q
    for (const Bond& b : bonds(all, driven, time)) {
        if (b.lower) most = std::max(most, b.mixing + b.largest_segregation());
    }
    for (Index z = 0; z < count(); ++z) {
        const double again = renewal(at(all, z), driven, z, time);
        parts = std::max(
            {parts, again / options.largest_mixing, most + again});  // no more than all may be replaced
    }
    const double part = time / std::ceil(parts * (1.0 - 1e-12));
    for (const Bond& b : bonds(all, driven, part)) {
        if (!b.lower) continue;
        const double q = b.largest_segregation();
        report.largest_probability =
            std::max(report.largest_probability, b.swaps().mixing + q * (1.0 - 0.5 * q));
    }
    return part;
}

// Crushes go with the grains that have been through them, those that change places with others of their size too.
void ColumnWork::carry_counts(OpenRow& open, Swaps swaps, bool lower, const Grains& own, const Grains& other,
                              std::vector<double>* inflow) const {
    const Index nodes = tables.triples.nodes();
    const auto swap_of = [&](Index mine, Index theirs) {
        const double distance =
            at(tables.sizes, lower ? mine : theirs) - at(tables.sizes, lower ? theirs : mine);
        const double q = swaps.segregation * std::max(distance, 0.0);
        return swaps.mixing + q * (1.0 - 0.5 * q);
    };
    for (Index x = 0; x < nodes; ++x) {
        double arrives = 0.0;
        double leaves = 0.0;
        for (Index y = 0; y < nodes; ++y) {
            arrives += swap_of(y, x) * at(own.share, y);
            leaves += swap_of(x, y) * at(other.share, y);
        }
        arrives *= at(other.share, x);
        open.counts[x] = open.counts[x] * (1.0 - leaves) + arrives * at(other.count, x);
        if (inflow) at(*inflow, x) += dz() * (arrives - leaves * at(own.share, x));
    }
}

void ColumnWork::sweep(const Driven& driven, double time, Index colour, ResolvedColumnReport& report) {
    const std::vector<Grains> all = grains();
    const std::vector<Bond> bonds = this->bonds(all, driven, time);
    const auto bond_of = [&](Index z) { return z % 2 == colour ? z : z - 1; };
    const auto hazard = [&](Index z) {
        return driven.drive.crush_rate == std::numeric_limits<double>::infinity()
                   ? std::numeric_limits<double>::infinity()
                   : driven.drive.crush_rate * driven.drive.shear_rate[z] * 0.5 * time;
    };
    if (options.partners == Partners::shift) {
        for_each_row(
            [&](Index z, Tools& tools) {
                const Bond& bond = bonds[static_cast<std::size_t>(bond_of(z) + 1)];
                if (bond_of(z) != z || !bond.lower) return;
                const Index above = z + 1 < count() ? z + 1 : 0;
                FreshPairs fresh(tables.triples);
                OpenRow& lower = row(z).law();
                OpenRow& upper = row(above).law();
                exchange_shifted(tables.triples, tables.sizes, bond.swaps(), tools.exchange, lower.law,
                                 tools.fresh, upper.law, fresh);
                carry_counts(lower, bond.swaps(), true, *bond.lower, *bond.upper, nullptr);
                carry_counts(upper, bond.swaps(), false, *bond.upper, *bond.lower, nullptr);
                tools.settling.run(lower, &tools.fresh, hazard(z));
                tools.settling.run(upper, &fresh, hazard(above));
            },
            {});
    } else {
        for_each_row(
            [&](Index z, Tools& tools) {
                const Grains& own = all[static_cast<std::size_t>(z)];
                const Bond& bond = bonds[static_cast<std::size_t>(bond_of(z) + 1)];
                const bool lower = bond_of(z) == z;
                const Grains* other = bond.lower ? (lower ? bond.upper : bond.lower) : nullptr;
                const double again = -std::expm1(-renewal(own, driven, z, time));
                OpenRow& open = row(z).law();
                if (!other && again <= 0.0) {
                    tools.settling.run(open, nullptr, hazard(z));
                    return;
                }
                const ArrivalRates rates(
                    tables.sizes,
                    {bond.swaps(), lower, other ? other->share.data() : nullptr, again, own.share.data()});
                tools.exchange.permuted(rates, open.law, tools.fresh);
                if (other)
                    carry_counts(open, bond.swaps(), lower, own, *other,
                                 other == &driven.feed ? &report.inflow : nullptr);
                tools.settling.run(open, &tools.fresh, hazard(z));
            },
            {});
    }
    ++sweeps;
}

// The law knows what share of a triple has been tested, and not under which load.
void ColumnWork::require_no_fall(Index z, Index place, double load) const {
    const double largest = row(z).largest_load();
    if (load >= largest) return;
    throw ParameterError(
        {.parameter = "stress_ratio",
         .value = text(load),
         .number = load,
         .rule = "it must be at least " + text(largest) +
                 ", the largest so far of the grains there, while any are exchanged: a law of three "
                 "cells does not know which of its cells have met a higher load; a lattice does",
         .place = {entry("stress_ratio", {place})}});
}

// A row of the feed is full: it takes its place, every other moves on by one, and the last one leaves.
void ColumnWork::push(const Driven& driven, ResolvedColumnReport& report) {
    const bool from_top = driven.ends.top == ColumnEnd::feed;
    const std::vector<double> places = loads();
    for (Index z = 0; z < count(); ++z) {
        const Index from = from_top ? z + 1 : z - 1;
        if (from >= 0 && from < count()) require_no_fall(from, z, at(places, z));
    }
    const std::vector<double> leaving = (from_top ? rows.front() : rows.back()).pmf(tables);
    const double solid = dz();
    for (std::size_t i = 0; i < leaving.size(); ++i)
        report.inflow[i] += solid * (driven.feed.share[i] - leaving[i]);
    if (from_top) {
        rows.pop_front();
        rows.emplace_back(tables, driven.feed.share);
    } else {
        rows.pop_back();
        rows.emplace_front(tables, driven.feed.share);
    }
    fed = 0.0;
    const bool at_once = driven.drive.crush_rate == std::numeric_limits<double>::infinity();
    for_each_row(
        [&](Index z, Tools& tools) {
            const double load = at(places, z);
            at_once ? row(z).load_to(tables, load, tools.settling)
                    : row(z).stand_under(tables, load, tools.settling);
            row(z).open(tables, tools.settling);
        },
        {});
}

}  // namespace comminute::detail
