// SPDX-License-Identifier: BSD-3-Clause
// The order of the parts of a step is that of the closed law (resolved/triple_step.cpp); what is added are labels of pairs,
// the competition of two pending neighbours, and the bound that lets it be told.
#include "columns/settling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/check.hpp"
#include "simd/loops.hpp"
#include "simd/products.hpp"
#include "simd/transport.hpp"

namespace comminute::detail {

namespace {

constexpr double negligible_mass = 1e-200;  // of which shares would be rounded to nothing; it stays pending
constexpr double rival_mass = 1e-100;       // from which on a pending neighbour may be first
constexpr Index most_steps = 100000;
constexpr double least_rest = 1e-12;  // pending mass that counts as none

constexpr Index pair_of(Index a, Index c) {
    return a * (a + 1) / 2 + c;  // c <= a
}

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

void Settling::run(OpenRow& row, FreshPairs* fresh, double hazard) {
    used_kinds_ = fresh ? kinds : 1;
    row_ = &row.law;
    settled_ = {row.law.settled().data(), nullptr, nullptr};
    pending_ = {row.law.pending().data(), nullptr, nullptr};
    if (fresh) {
        settled_ = fresh->settled_of(row.law);
        pending_ = fresh->pending_of(row.law);
    }
    for (Index steps = 0; hazard > 0.0 && count_pending() > std::max(rules_.rest, least_rest); ++steps) {
        if (steps > most_steps)
            throw ParameterError({.parameter = "rest",
                                  .value = text(rules_.rest),
                                  .number = rules_.rest,
                                  .finding = "is not reached in " + std::to_string(most_steps) + " steps",
                                  .rule = "it must be greater"});
        hazard -= step(row, hazard);
    }
    if (fresh) fresh->merge(tables_, row.law);
}

void Settling::come_to_rest(OpenRow& row) {
    const double rest = rules_.rest;
    rules_.rest = 0.0;
    run(row, nullptr, std::numeric_limits<double>::infinity());
    rules_.rest = rest;
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
        used_kinds_ = 1;
        row_ = &law;
        settled_[0] = law.settled().data();
        pending_[0] = law.pending().data();
        if (count_pending() > 0.0) this->step(row, std::numeric_limits<double>::infinity());
    }
    run(row, nullptr, std::numeric_limits<double>::infinity());
}

double Settling::step(OpenRow& row, double hazard) {
    count_pairs();
    const double theta = released(hazard);
    compete(theta);
    release(theta);
    crush_between_pairs();
    count_crushes(row);
    replace_sides(row.law);
    settle_landed();
    return theta < 1.0 ? -std::log1p(-theta) : std::numeric_limits<double>::infinity();
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
    return hazard < std::numeric_limits<double>::infinity() ? std::min(theta, -std::expm1(-hazard)) : theta;
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
            for (Index c = reach.first; c <= std::min(reach.last, a); ++c) ++first_of_pair_[pair_of(a, c) + 1];
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

// Of two directions of a triple the one with c <= a is looked at, and the other gets the same.
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

void Settling::crush_between_pairs() {
    for (LaneArray& landed : landed_) {  // of the row before too, which may have had more kinds
        for (const Index from : written_) std::fill_n(landed.data() + from, stride_, 0.0);
    }
    for (Index kind = 0; kind < used_kinds_; ++kind) {
        for (Index a = 0; a < nodes_; ++a) {
            for (Index b = 0; b < nodes_; ++b) {
                if (at(crushing_, kind)[b * stride_ + a] > 0.0)
                    std::fill_n(at(beside_, kind).data() + place(a, b), b + 1, 0.0);
            }
        }
    }
    written_.clear();
    std::fill(lands_beside_.begin(), lands_beside_.end(), static_cast<unsigned char>(0));
    std::fill(weighted_nodes_.begin(), weighted_nodes_.end(), 0.0);
    std::fill(went_on_.begin(), went_on_.end(), 0.0);
    for (Index a = 0; a < nodes_; ++a) {
        for (Index c = 0; c <= a; ++c) {
            Active* active = active_.data() + first_of_pair_[pair_of(a, c)];
            Index count = first_of_pair_[pair_of(a, c) + 1] - first_of_pair_[pair_of(a, c)];
            const auto none = [](const Active& of) {
                return of.crushes[0] + of.crushes[1] + of.crushes[2] + of.crushes[3] <= 0.0;
            };
            while (count > 0 && none(active[count - 1])) --count;
            if (count > 0) crush_between(a, c, active, count);
        }
    }
}

// As TripleState::crush_between_pairs has it. A fragment's crushes until it rests: with V the visits of the active nodes,
// of which a share Q goes on to others, they are V (1 - Q)^-1 by node from which it comes to rest.
void Settling::crush_between(Index a, Index c, Active* active, Index count) {
    lands_beside_[a] = lands_beside_[c] = 1;
    written_.push_back(place(a, c));
    if (c != a) written_.push_back(place(c, a));
    const auto land = [&](Index kind, Index left, Index right, double mass, const double* outcome, Index size) {
        if (mass > 0.0) add_scaled(mass, outcome, at(landed_, kind).data() + place(left, right), size);
    };
    const auto next_to = [&](Index label, Index of, Index b, double mass, const double* outcome) {
        if (mass > 0.0) add_scaled(mass, outcome, at(beside_, label).data() + place(of, b), b + 1);
    };
    for (Index k = 0; k < count; ++k) {
        const Index b = active[k].node;
        const double* once = tables_.fragments(b);
        double* outcome = outcome_.data() + k * stride_;
        std::copy_n(once, lanes_up(b + 1), outcome);
        for (Index i = 0; i <= k; ++i) outcome[active[i].node] *= 1.0 - active[i].share;
        for (Index i = 0; i < k; ++i) {
            const double again = once[active[i].node] * active[i].share;
            if (again != 0.0) add_scaled(again, outcome_.data() + i * stride_, outcome, active[i].node + 1);
        }
        const double stays = 1.0 / (1.0 - once[b] * active[k].share);
        for (Index i = 0; i <= b; ++i) outcome[i] *= stays;
        const auto& [old, centre, left, right] = active[k].crushes;
        visits_[k] = (c != a ? 2.0 * (old + centre + left + right) : old + centre + 2.0 * left);
        land(old_pairs, a, c, old, outcome, b + 1);
        land(new_centre, a, c, centre, outcome, b + 1);
        land(new_left, a, c, left, outcome, b + 1);
        next_to(0, a, b, old + right, outcome);
        next_to(1, a, b, centre, outcome);
        next_to(2, a, b, left, outcome);
        if (c == a) {
            next_to(0, a, b, left, outcome);
            continue;
        }
        land(new_left, c, a, right, outcome, b + 1);
        next_to(0, c, b, old + left, outcome);
        next_to(1, c, b, centre, outcome);
        next_to(2, c, b, right, outcome);
    }
    for (Index kind = 0; kind < std::min(used_kinds_, new_left); ++kind) {
        if (c != a) std::copy_n(at(landed_, kind).data() + place(a, c), stride_, at(landed_, kind).data() + place(c, a));
    }
    for (Index k = count - 1; k >= 0; --k) {
        weighted_[k] = 0.0;
        for (Index j = count - 1; j > k; --j) {
            const double on = tables_.fragments(active[j].node)[active[k].node] * active[k].share;
            visits_[k] += visits_[j] * on;
            weighted_[k] += weighted_[j] * on;
        }
        const Index b = active[k].node;
        const double stays = 1.0 / (1.0 - tables_.fragments(b)[b] * active[k].share);
        visits_[k] *= stays;
        weighted_[k] = (weighted_[k] + visits_[k]) * stays;
        weighted_nodes_[b] += weighted_[k];
        for (Index i = 0; i <= k; ++i)
            went_on_[active[i].node] += weighted_[k] * tables_.fragments(b)[active[i].node] * active[i].share;
    }
}

// The crushes that a grain has been through go with it and its fragments.
void Settling::count_crushes(OpenRow& row) {
    const std::vector<double> before = row.counts.vector();
    for (Index b = 1; b < nodes_; ++b) {
        add_scaled(weighted_nodes_[b], tables_.fragments(b), row.counts.data(), b + 1);
        row.counts[b] -= went_on_[b];
        if (crushed_[b] <= 0.0) continue;
        double of_node = 0.0;
        for (Index label = 0; label < used_kinds_; ++label)
            of_node += sum(at(pairs_, label).data() + b * stride_, nodes_);
        const double each = at(before, b) / of_node;
        if (each == 0.0) continue;
        for (Index label = 0; label < used_kinds_; ++label) {
            for (Index a = 0; a < nodes_; ++a) {
                if (at(crushing_, label)[b * stride_ + a] > 0.0)
                    add_scaled(each, at(beside_, label).data() + place(a, b), row.counts.data(), b + 1);
            }
        }
        row.counts[b] -= each * crushed_[b];
    }
}

// Neighbours b of a centre a that crush, and the fragments that take their place, for one label of the pair.
void Settling::set_factors(Index a, Index label) {
    const Index turned = at(dual, label);
    LaneArray& leaves = at(leaves_, label);
    columns_.clear();
    std::fill(leaves.begin(), leaves.end(), 0.0);
    for (Index b = 1; b < nodes_; ++b) {
        const double crushing = at(crushing_, turned)[b * stride_ + a];
        if (crushing <= 0.0) continue;
        const Index pair = a * stride_ + b;
        const double keeping =
            at(pairs_, label)[pair] - at(crushing_, label)[pair] - at(lost_either_, label)[pair];
        const double rest = crushing - at(lost_, label)[pair];
        leaves[b] = keeping > 0.0 ? std::clamp(rest / keeping, 0.0, 0.5) : 0.0;
        double* factor = factor_.data() + columns_.size() * stride_;
        const double* beside = at(beside_, turned).data() + place(a, b);
        const double share = 1.0 / crushing;
        for (Index i = 0; i <= b; ++i) factor[i] = beside[i] * share;
        std::fill(factor + b + 1, factor + stride_, 0.0);
        columns_.push_back(b);
    }
}

void Settling::move(Index a, Index kind, Index label, const LaneArray& lost, bool left, LaneArray& moved) {
    const Index terms = columns_.size();
    const double* settled = at(settled_, kind);
    const double* pending = at(pending_, kind);
    const LaneArray& leaves = at(leaves_, label);
    for (Index z = 0; z < nodes_; ++z) {
        double* around = around_.data() + z * stride_;
        for (Index t = 0; t < terms; ++t) {
            const Index b = columns_[t];
            const Index k = left ? place(a, b) + z : place(a, z) + b;
            const Reach reach = left ? row_->reach(tables_, a, b) : row_->reach(tables_, a, z);
            const Index third = left ? z : b;
            double mass = settled[k] * leaves[b];
            if (third >= reach.first && third <= reach.last) mass += pending[k] * leaves[b] + lost[k];
            around[t] = mass;
        }
    }
    multiply_lower({around_.data(), columns_.data(), factor_.data(), terms, stride_}, moved.data(), nodes_);
}

void Settling::replace_sides(const TripleState& row) {
    for (Index a = 0; a < nodes_; ++a) {
        bool any = false;
        for (Index label = 0; label < used_kinds_; ++label) {
            const Index turned = at(dual, label);
            bool here = false;
            for (Index b = 1; b < nodes_ && !here; ++b) here = at(crushing_, turned)[b * stride_ + a] > 0.0;
            any = any || here;
        }
        if (!any) continue;
        std::array<bool, labels> moves{};
        LaneArray& right = moved_[0];
        if (used_kinds_ == kinds) {
            set_factors(a, 1);
            if (!columns_.empty()) {
                move(a, new_centre, 1, lost_right_[new_centre], false, right);
                add_mirror(right);
                settle_moved(row, a, new_centre);
            }
            set_factors(a, 2);
            moves[2] = !columns_.empty();
            move(a, new_left, 2, lost_left_, true, moved_[1]);
        }
        set_factors(a, 0);
        if (used_kinds_ == kinds && (moves[2] || !columns_.empty())) {
            move(a, new_left, 0, lost_right_[new_left], false, right);
            turn(moved_[1].data(), turned_.data());
            add_scaled(1.0, turned_.data(), right.data(), nodes_ * stride_);
            settle_moved(row, a, new_left);
        }
        if (columns_.empty()) continue;
        move(a, old_pairs, 0, lost_right_[old_pairs], false, right);
        add_mirror(right);
        settle_moved(row, a, old_pairs);
    }
}

void Settling::settle_moved(const TripleState& row, Index a, Index kind) {
    const LaneArray& left = at(leaves_, at(left_label, kind));
    const LaneArray& right = at(leaves_, at(right_label, kind));
    const LaneArray& moved = moved_[0];
    const double* active = row.share().data() + place(a, 0);
    detail::replace_sides({left.data(), right.data(), active, moved.data()}, at(settled_, kind) + place(a, 0), nodes_,
                          stride_);
    for (Index z = 0; z < nodes_; ++z) {
        double* pending = at(pending_, kind) + place(a, z);
        const Reach reach = row.reach(tables_, a, z);
        for (Index b = reach.first; b <= reach.last; ++b) {
            const Index k = z * stride_ + b;
            pending[b] = pending[b] * (1.0 - (left[z] + right[b])) + active[k] * moved[k];
        }
    }
}

// The fragments beside each left neighbour, turned to have the right one along a row.
void Settling::settle_landed() {
    for (Index kind = 0; kind < used_kinds_; ++kind) {
        for (Index a = 0; a < nodes_; ++a) {
            if (lands_beside_[a] == 0) continue;
            turn(at(landed_, kind).data() + place(a, 0), turned_.data());
            for (Index b = 0; b < nodes_; ++b) {
                double* settled = at(settled_, kind) + place(b, a);
                const double* landed = turned_.data() + b * stride_;
                for (Index c = 0; c < nodes_; ++c) settled[c] += landed[c];
            }
        }
    }
}

void Settling::turn(const double* from, double* to) const {
    transpose(from, stride_, to, stride_, lanes_up(nodes_));
}

// The sum is symmetric to the bit.
void Settling::add_mirror(LaneArray& table) {
    turn(table.data(), turned_.data());
    add_scaled(1.0, turned_.data(), table.data(), nodes_ * stride_);
}

}  // namespace comminute::detail
