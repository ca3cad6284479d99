// SPDX-License-Identifier: BSD-3-Clause
// Steps of crushes (docs/theory/columns.md, section 3). The order of their parts is that of the closed law
// (resolved/triple_step.cpp); what is added are labels of pairs, the competition of two pending neighbours, and the bound
// that lets it be told.
#include "columns/settling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/check.hpp"
#include "simd/transport.hpp"

namespace comminute::detail {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double negligible_mass = 1e-200;  // of which shares would be rounded to nothing; it stays pending
constexpr double rival_mass = 1e-100;       // from which on a pending neighbour may be first
constexpr Index most_steps = 100000;
constexpr double least_rest = 1e-12;  // pending mass that counts as none

template <std::size_t Count>
void clear(std::array<LaneArray, Count>& arrays, Index used) {
    for (Index k = 0; k < used; ++k) std::fill(at(arrays, k).begin(), at(arrays, k).end(), 0.0);
}

}  // namespace

Settling::Settling(const TripleTables& tables, const SettlingRules& rules)
    : tables_(tables),
      rules_(rules),
      nodes_(tables.nodes()),
      stride_(tables.stride()),
      lost_left_(nodes_ * nodes_ * stride_),
      first_of_pair_(pair_of(nodes_, 0) + 1),
      next_of_pair_(pair_of(nodes_, 0)),
      lands_beside_(nodes_),
      outcome_(nodes_ * stride_),
      visits_(nodes_),
      weighted_(nodes_),
      weighted_nodes_(nodes_),
      went_on_(nodes_),
      crushed_(nodes_),
      around_(nodes_ * stride_),
      factor_(nodes_ * stride_),
      turned_(lanes_up(nodes_) * stride_) {
    for (Pairs* pairs : {&pairs_, &waiting_, &limit_, &sooner_, &crushing_, &lost_, &lost_either_}) {
        for (LaneArray& of_label : *pairs) of_label.assign(nodes_ * stride_, 0.0);
    }
    for (Cells* cells : {&lost_right_, &landed_, &beside_}) {
        // whole squares of packs are read where one is turned
        for (LaneArray& of_kind : *cells) of_kind.assign((nodes_ * nodes_ + lanes) * stride_, 0.0);
    }
    for (LaneArray& leaves : leaves_) leaves.assign(stride_, 0.0);
    for (LaneArray& moved : moved_) moved.assign(turned_.size(), 0.0);
}

void Settling::take(OpenRow& row, FreshPairs* fresh) {
    used_kinds_ = fresh ? kinds : 1;
    row_ = &row.law;
    settled_ = {row.law.settled().data(), nullptr, nullptr};
    pending_ = {row.law.pending().data(), nullptr, nullptr};
    if (!fresh) return;
    settled_ = fresh->settled_of(row.law);
    pending_ = fresh->pending_of(row.law);
}

void Settling::crush(OpenRow& row, FreshPairs* fresh, double hazard, double rest) {
    take(row, fresh);
    for (Index steps = 0; hazard > 0.0 && count_pending() > rest; ++steps) {
        if (steps > most_steps)
            throw ParameterError({.parameter = "rest",
                                  .value = text(rest),
                                  .number = rest,
                                  .finding = "is not reached in " + std::to_string(most_steps) + " steps",
                                  .rule = "it must be greater"});
        hazard -= step(row, hazard);
    }
    if (fresh) fresh->merge(tables_, row.law);
}

void Settling::come_to_rest(OpenRow& row) {
    crush(row, nullptr, infinity, std::min(least_rest, rules_.rest));
}

void Settling::raise(OpenRow& row, double log_load, double max_step) {
    constexpr double least_step = 1e-7;
    TripleState& law = row.law;
    if (!(tables_.level(log_load) > law.level())) return;
    double reached = tables_.log_stress_ratio(law.level());
    double hint = 0.01;
    while (reached < log_load) {
        double step = std::min({hint, max_step, log_load - reached});
        double hardness = 0.0;
        while (true) {
            hardness = law.overrun_mass(tables_, tables_.level(reached + step)) / rules_.tolerance;
            if (!(hardness > 1.0) || step < least_step) break;
            step *= std::clamp(0.9 / hardness, 0.1, 0.8);
        }
        hint = step * (hardness > 0.0 ? std::clamp(0.9 / hardness, 1.0, 4.0) : 4.0);
        reached = log_load - reached <= step ? log_load : reached + step;
        law.overrun(tables_, tables_.level(reached));
        take(row, nullptr);
        if (count_pending() > 0.0) this->step(row, infinity);
    }
    run(row, nullptr, infinity);
}

double Settling::step(OpenRow& row, double hazard) {
    count_pairs();
    const double theta = released(hazard);
    compete(theta);
    release(theta);
    crush_between_pairs();
    count_crushes(row);
    replace_neighbours(row.law);
    settle_landed();
    return theta < 1.0 ? -std::log1p(-theta) : infinity;
}

// Pending mass of every pair; the sum of all.
double Settling::count_pending() {
    clear(waiting_, used_kinds_);
    double total = 0.0;
    for (Index b = 1; b < nodes_; ++b) {
        for (Index a = 0; a < nodes_; ++a) {
            const Reach reach = row_->reach(tables_, b, a);
            if (reach.empty()) continue;
            for (Index kind = 0; kind < used_kinds_; ++kind) {
                const double* pending = at(pending_, kind) + place(b, a);
                double sum = 0.0;
                for (Index c = reach.first; c <= reach.last; ++c) sum += pending[c];
                if (sum == 0.0) continue;
                at(waiting_, at(left_label, kind))[b * stride_ + a] += sum;
                total += kind == new_left ? 2.0 * sum : sum;
                if (kind != new_left) continue;
                double* mirror = waiting_[0].data() + b * stride_;
                for (Index c = reach.first; c <= reach.last; ++c) mirror[c] += pending[c];
            }
        }
    }
    return total;
}

void Settling::count_pairs() {
    for (Index label = 0; label < used_kinds_; ++label) at(pairs_, label) = at(waiting_, label);
    for (Index kind = 0; kind < used_kinds_; ++kind) {
        for (Index b = 0; b < nodes_; ++b) {
            const double* settled = at(settled_, kind) + place(b, 0);
            sum_rows(settled, at(pairs_, at(left_label, kind)).data() + b * stride_, nodes_, stride_);
            if (kind == new_left) sum_columns(settled, pairs_[0].data() + b * stride_, nodes_, stride_);
        }
    }
}

// Share of the pending mass that may crush in this step.
double Settling::released(double hazard) {
    double total = 0.0;
    double clash = 0.0;
    double fresh = 0.0;
    double fresh_clash = 0.0;
    for (Index label = 0; label < used_kinds_; ++label) {
        for (Index b = 1; b < nodes_; ++b) {
            for (Index a = 0; a < nodes_; ++a) {
                const double waiting = at(waiting_, label)[b * stride_ + a];
                if (waiting <= 0.0) continue;
                const double both = waiting * waiting / at(pairs_, label)[b * stride_ + a];
                total += waiting;
                (label == 0 ? clash : fresh_clash) += both;
                if (label != 0) fresh += waiting;
            }
        }
    }
    double theta = std::min(1.0, rules_.tolerance / std::max(total, std::sqrt(clash)));
    if (fresh_clash > 0.0) theta = std::min(theta, rules_.competition * fresh / fresh_clash);
    return hazard < infinity ? std::min(theta, -std::expm1(-hazard)) : theta;
}

// No more of a pair may crush at once than leaves either side half of what it has. Where both cells of a pair are released,
// either is the first in half of the cases, and spares the other as a rule.
void Settling::compete(double theta) {
    for (Index label = 0; label < used_kinds_; ++label) {
        const Index turned = at(dual, label);
        for (Index b = 0; b < nodes_; ++b) {
            for (Index a = 0; a < nodes_; ++a) {
                const Index from_b = b * stride_ + a;
                const Index from_a = a * stride_ + b;
                const double one = theta * at(waiting_, label)[from_b];
                const double other = theta * at(waiting_, turned)[from_a];
                const double most = 2.0 * std::max(one, other) + std::min(one, other);
                const double mass = std::min(at(pairs_, label)[from_b], at(pairs_, turned)[from_a]);
                const double limit = most > mass && most > 0.0 ? mass / most : 1.0;
                const double rival = limit * other;
                at(limit_, label)[from_b] = limit;
                at(sooner_, label)[from_b] =
                    rival > rival_mass ? std::min(0.5 * rival / at(pairs_, label)[from_b], 0.5) : 0.0;
            }
        }
    }
}

void Settling::release(double theta) {
    std::fill(first_of_pair_.begin(), first_of_pair_.end(), Index{0});
    for (Index b = 1; b < nodes_; ++b) {
        for (Index a = 0; a < nodes_; ++a) {
            const Reach reach = row_->reach(tables_, b, a);
            for (Index c = reach.first; c <= std::min(reach.last, a); ++c)
                ++first_of_pair_[pair_of(a, c) + 1];
        }
    }
    for (Index k = 0; k < next_of_pair_.size(); ++k) {
        next_of_pair_[k] = first_of_pair_[k];
        first_of_pair_[k + 1] += first_of_pair_[k];
    }
    active_.resize(static_cast<std::size_t>(first_of_pair_.back()));
    clear(crushing_, used_kinds_);
    clear(lost_, used_kinds_);
    clear(lost_either_, used_kinds_);
    std::fill(crushed_.begin(), crushed_.end(), 0.0);
    for (Index b = 1; b < nodes_; ++b) {
        for (Index a = 0; a < nodes_; ++a) release_beside(b, a, theta);
    }
}

// The direction of a triple with c <= a is looked at, and the other gets the same.
void Settling::release_beside(Index b, Index a, double theta) {
    const Reach reach = row_->reach(tables_, b, a);
    const auto crush = [&](Index kind, Index left, Index right) {
        const Index label = at(left_label, kind);
        const Index other = at(right_label, kind);
        const Index pair = b * stride_ + left;
        const Index pair_right = b * stride_ + right;
        const Index k = place(b, left) + right;
        double* pending = at(pending_, kind) + k;
        const double out = *pending * theta * at(limit_, label)[pair] * at(limit_, other)[pair_right];
        const double first = at(sooner_, label)[pair];
        const double second = at(sooner_, other)[pair_right];
        double crushes = out * ((1.0 - first) * (1.0 - second));
        double lost = out * (first * (1.0 - second));
        double lost_right = out * (second * (1.0 - first));
        if (crushes < negligible_mass) crushes = lost = lost_right = 0.0;
        *pending = std::max(*pending - (crushes + lost + lost_right), 0.0);
        at(crushing_, label)[pair] += crushes;
        at(lost_, label)[pair] += lost;
        at(lost_either_, label)[pair] += lost + lost_right;
        at(lost_right_, kind)[k] = lost_right;
        if (kind == new_left) {
            lost_left_[k] = lost;
            at(crushing_, other)[pair_right] += crushes;
            at(lost_, other)[pair_right] += lost_right;
            at(lost_either_, other)[pair_right] += lost + lost_right;
            crushed_[b] += 2.0 * crushes;
            return crushes;
        }
        crushed_[b] += crushes;
        if (left == right) return crushes;
        const Index mirror = place(b, right) + left;
        at(pending_, kind)[mirror] = *pending;
        at(crushing_, label)[pair_right] += crushes;
        at(lost_, label)[pair_right] += lost_right;
        at(lost_either_, label)[pair_right] += lost + lost_right;
        at(lost_right_, kind)[mirror] = lost;
        crushed_[b] += crushes;
        return crushes;
    };
    for (Index c = reach.first; c <= std::min(reach.last, a); ++c) {
        Active& found = at(active_, next_of_pair_[pair_of(a, c)]++);
        found = {b, row_->share()[place(b, a) + c], {crush(old_pairs, a, c), 0.0, 0.0, 0.0}};
        if (used_kinds_ == 1) continue;
        found.crushes[1] = crush(new_centre, a, c);
        found.crushes[2] = crush(new_left, a, c);
        if (a != c) found.crushes[3] = crush(new_left, c, a);
    }
}

}  // namespace comminute::detail
