// SPDX-License-Identifier: BSD-3-Clause
// The state of the three-cell law, and what a rise of the load overruns of it (docs/theory/three_cells.md, section 3).
#include "resolved/triple_state.hpp"

#include <algorithm>
#include <cmath>

#include "simd/loops.hpp"

namespace comminute::detail {

namespace {

void put(const TripleTables& tables, const std::vector<double>& mass, LaneArray& to) {
    const Index nodes = tables.nodes();
    for (Index k = 0; k < nodes * nodes; ++k)
        std::copy_n(mass.data() + k * nodes, nodes, to.data() + k * tables.stride());
}

}  // namespace

TripleState::TripleState(const TripleTables& tables, const std::vector<double>& pmf,
                         const std::vector<double>& endured)
    : settled_(tables.nodes() * tables.nodes() * tables.stride()),
      pending_(settled_.size()),
      share_(settled_.size()),
      own_(tables.material().strength_scatter ? settled_.size() : 0),
      endured_(own_.size()),
      reach_(tables.nodes() * tables.nodes()),
      level_(tables.lowest_level()) {
    const VectorView<const double> p(pmf);
    for (Index b = 0; b < tables.nodes(); ++b) {
        for (Index a = 0; a < tables.nodes(); ++a) {
            double* to = settled_.data() + row(tables, b, a);
            for (Index c = 0; c < tables.nodes(); ++c) to[c] = p[b] * (p[a] * p[c]);
            if (endured_.empty() || endured.empty()) continue;
            double* borne = endured_.data() + row(tables, b, a);
            for (Index c = 0; c < tables.nodes(); ++c) borne[c] = to[c] * detail::at(endured, b);
        }
    }
}

TripleState::TripleState(const TripleTables& tables, Triples mass)
    : TripleState(tables, std::vector<double>(static_cast<std::size_t>(tables.nodes()), 0.0)) {
    put(tables, mass.mass, settled_);
}

TripleState::TripleState(const TripleTables& tables, const TripleRecord& record)
    : TripleState(tables, Triples{record.settled}) {
    if (!endured_.empty()) put(tables, record.endured, endured_);
    level_ = record.level;
    crushes_ = record.crushes;
    avalanches_ = record.avalanches;
    put(tables, record.pending, pending_);
    const Index nodes = tables.nodes();
    tables.for_each_reach(level_, [&](Index b, Index a, Reach reach, const CentreZone& zone) {
        reach_[b * nodes + a] = reach;
        for (Index c = reach.first; c <= reach.last; ++c) {
            const Index k = row(tables, b, a) + c;
            share_[k] = tables.share(b, a, c, level_, zone);
            if (!own_.empty()) own_[k] = tables.endured(b, a, c, zone, share_[k]);
        }
    });
}

TripleRecord TripleState::record(const TripleTables& tables) const {
    const Index nodes = tables.nodes();
    TripleRecord record{{}, {}, {}, level_, crushes_, avalanches_};
    const auto take = [&](const LaneArray& from, std::vector<double>& to) {
        if (from.empty()) return;
        for (Index k = 0; k < nodes * nodes; ++k) {
            const double* row = from.data() + k * tables.stride();
            to.insert(to.end(), row, row + nodes);
        }
    };
    take(settled_, record.settled);
    take(pending_, record.pending);
    take(endured_, record.endured);
    return record;
}

std::vector<double> TripleState::pmf(const TripleTables& tables) const {
    std::vector<double> mass;
    for (Index b = 0; b < tables.nodes(); ++b) {
        double sum = 0.0;
        for (Index a = 0; a < tables.nodes(); ++a) sum += pair_mass(tables, b, a);
        mass.push_back(sum);
    }
    return mass;
}

std::vector<double> TripleState::endured(const TripleTables& tables) const {
    std::vector<double> hazard;
    if (endured_.empty()) return hazard;
    const Index block = tables.nodes() * tables.stride();
    for (Index b = 0; b < tables.nodes(); ++b) {
        const double mass = sum(settled_.data() + b * block, block);
        hazard.push_back(mass > 0.0 ? sum(endured_.data() + b * block, block) / mass : 0.0);
    }
    return hazard;
}

// Pending mass lies where the share is not 0.
double TripleState::pair_mass(const TripleTables& tables, Index b, Index a) const {
    const Index at = row(tables, b, a);
    const Reach reach = reach_[b * tables.nodes() + a];
    double mass = sum(settled_.data() + at, tables.nodes());
    for (Index c = reach.first; c <= reach.last; ++c) mass += pending_[at + c];
    return mass;
}

double TripleState::overrun_mass(const TripleTables& tables, double level) const {
    double total = 0.0;
    double clash = 0.0;
    tables.for_each_reach(level, [&](Index b, Index a, Reach reach, const CentreZone& zone) {
        const Index at = row(tables, b, a);
        double shell = 0.0;
        for (Index c = reach.first; c <= reach.last; ++c) {
            if (share_[at + c] == 1.0 || settled_[at + c] == 0.0) continue;
            shell += taken(at + c, tables.share(b, a, c, level, zone));
        }
        if (shell <= 0.0) return;
        total += shell;
        clash += shell * shell / pair_mass(tables, b, a);
    });
    return std::max(total, std::sqrt(clash));
}

// Zones are nested, and settled mass lies evenly outside the one before. Scattered strengths that have borne a hazard are
// a share e^(h - h') of themselves under a greater one.
double TripleState::taken(Index at, double after) const {
    if (endured_.empty()) {
        const double before = share_[at];
        return before < 1.0 ? settled_[at] * (std::max(after - before, 0.0) / (1.0 - before)) : 0.0;
    }
    if (!(settled_[at] > 0.0)) return 0.0;
    const double more = hazard_of(after) - std::max(hazard_of(share_[at]), endured_[at] / settled_[at]);
    return more > 0.0 ? settled_[at] * -std::expm1(-more) : 0.0;
}

void TripleState::overrun(const TripleTables& tables, double level) {
    level_ = level;
    tables.for_each_reach(level, [&](Index b, Index a, Reach reach, const CentreZone& zone) {
        const Index at = row(tables, b, a);
        reach_[b * tables.nodes() + a] = reach;
        for (Index k = at + reach.first; k <= at + reach.last; ++k) {
            if (share_[k] == 1.0 && (endured_.empty() || settled_[k] == 0.0)) continue;
            const double after = tables.share(b, a, k - at, level, zone);
            const double mass = taken(k, after);
            const double kept = settled_[k] > 0.0 ? 1.0 - mass / settled_[k] : 1.0;
            settled_[k] -= mass;
            pending_[k] += mass;
            avalanches_ += mass;
            share_[k] = after;
            if (endured_.empty()) continue;
            own_[k] = tables.endured(b, a, k - at, zone, after);
            endured_[k] = std::max(endured_[k] * kept, settled_[k] * own_[k]);
        }
    });
}

}  // namespace comminute::detail
