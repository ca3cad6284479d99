// SPDX-License-Identifier: BSD-3-Clause
// Fragments of what is released, and the neighbours that see them (docs/theory/columns.md, section 3).
#include <algorithm>
#include <cmath>

#include "columns/settling.hpp"
#include "simd/loops.hpp"
#include "simd/products.hpp"
#include "simd/transport.hpp"

namespace comminute::detail {

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

// The chain of crushes is that of TripleState::crush_between_pairs. With V the visits of the active nodes, of which a share
// Q goes on to others, the crushes until a fragment rests are V (1 - Q)^-1, by the node from which it comes to rest.
void Settling::crush_between(Index a, Index c, Active* active, Index count) {
    lands_beside_[a] = lands_beside_[c] = 1;
    written_.push_back(place(a, c));
    if (c != a) written_.push_back(place(c, a));
    const auto land = [&](Index kind, Index left, Index right, double mass, const double* outcome,
                          Index size) {
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
        if (c != a)
            std::copy_n(at(landed_, kind).data() + place(a, c), stride_,
                        at(landed_, kind).data() + place(c, a));
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

// The sides of a centre by kind: what moves by one label is put down before the next label's factors are made.
void Settling::replace_neighbours(const TripleState& row) {
    LaneArray& right = moved_[0];
    for (Index a = 0; a < nodes_; ++a) {
        bool from_left = false;
        if (used_kinds_ == kinds) {
            set_factors(a, 1);
            if (!columns_.empty()) {
                move(a, new_centre, 1, lost_right_[new_centre], false, right);
                add_mirror(right);
                settle_moved(row, a, new_centre);
            }
            set_factors(a, 2);
            from_left = !columns_.empty();
            if (from_left) {
                move(a, new_left, 2, lost_left_, true, moved_[1]);
                turn(moved_[1].data(), turned_.data());
            }
        }
        set_factors(a, 0);
        if (used_kinds_ == kinds && (from_left || !columns_.empty())) {
            move(a, new_left, 0, lost_right_[new_left], false, right);
            if (from_left) add_scaled(1.0, turned_.data(), right.data(), nodes_ * stride_);
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
    replace_sides({left.data(), right.data(), active, moved.data()}, at(settled_, kind) + place(a, 0), nodes_,
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
