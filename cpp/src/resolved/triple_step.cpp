// SPDX-License-Identifier: BSD-3-Clause
// One step of the three-cell law (docs/theory/three_cells.md, section 4). The order of its parts matters: the zone
// overruns, cells crush with their fragments among the same neighbours, and only then their neighbours see them smaller.
#include <algorithm>
#include <cmath>

#include "resolved/triple_state.hpp"
#include "simd/loops.hpp"
#include "simd/products.hpp"

namespace comminute::detail {

namespace {

// Mass so small that shares of it would be rounded to nothing or to all of it; it stays pending.
constexpr double negligible_mass = 1e-200;

constexpr Index pair_of(Index a, Index c) {
    return a * (a + 1) / 2 + c;  // c <= a
}

}  // namespace

TripleScratch::TripleScratch(const TripleTables& tables)
    : first_of_pair(pair_of(tables.nodes(), 0) + 1),
      next_of_pair(pair_of(tables.nodes(), 0)),
      limit(tables.nodes() * tables.stride()),
      pending(tables.nodes() * tables.stride()),
      pairs(tables.nodes() * tables.stride()),
      crushing(tables.nodes() * tables.stride()),
      landed(tables.nodes() * tables.nodes() * tables.stride()),
      beside(tables.nodes() * tables.nodes() * tables.stride()),
      outcome(tables.nodes() * tables.stride()),
      count(tables.nodes()),
      around(tables.nodes() * tables.stride()),
      moved(lanes_up(tables.nodes()) * tables.stride()),
      moved_pending(tables.material().strength_scatter ? moved.size() : 0),
      moved_endured(tables.material().strength_scatter ? moved.size() : 0),
      factor(tables.nodes() * tables.stride()),
      leaves(tables.stride()) {}

void TripleState::step(const TripleTables& tables, double level, TripleScratch& scratch) {
    overrun(tables, level);
    count_pairs(tables, scratch);
    release(tables, scratch);
    crush_between_pairs(tables, scratch);
    replace_sides(tables, scratch);
    settle_landed(tables, scratch);
}

void TripleState::count_pairs(const TripleTables& tables, TripleScratch& scratch) const {
    for (Index b = 0; b < tables.nodes(); ++b) {
        for (Index a = 0; a < tables.nodes(); ++a) {
            const Index at = row(tables, b, a);
            const Reach reach = reach_[b * tables.nodes() + a];
            double pending = 0.0;
            for (Index c = reach.first; c <= reach.last; ++c) pending += pending_[at + c];
            scratch.pending[b * tables.stride() + a] = pending;
            scratch.pairs[b * tables.stride() + a] = sum(settled_.data() + at, tables.nodes()) + pending;
        }
    }
}

// No more of a pair may crush in one step than leaves either side half of what it has. Nearly always that is all.
void TripleState::release(const TripleTables& tables, TripleScratch& scratch) {
    const Index nodes = tables.nodes();
    const Index stride = tables.stride();
    for (Index b = 0; b < nodes; ++b) {
        for (Index a = 0; a <= b; ++a) {
            const double one = scratch.pending[b * stride + a];
            const double other = scratch.pending[a * stride + b];
            const double most = 2.0 * std::max(one, other) + std::min(one, other);
            const double mass = std::min(scratch.pairs[b * stride + a], scratch.pairs[a * stride + b]);
            const double limit = most > mass && most > 0.0 ? mass / most : 1.0;
            scratch.limit[b * stride + a] = scratch.limit[a * stride + b] = limit;
        }
    }

    std::fill(scratch.first_of_pair.begin(), scratch.first_of_pair.end(), Index{0});
    const auto for_each_pending = [&](const auto& visit) {
        for (Index b = 1; b < nodes; ++b) {
            for (Index a = 0; a < nodes; ++a) visit(b, a, reach_[b * nodes + a]);
        }
    };
    for_each_pending([&](Index, Index a, Reach reach) {
        for (Index c = reach.first; c <= std::min(reach.last, a); ++c)
            ++scratch.first_of_pair[pair_of(a, c) + 1];
    });
    for (Index k = 0; k < scratch.next_of_pair.size(); ++k) {
        scratch.next_of_pair[k] = scratch.first_of_pair[k];
        scratch.first_of_pair[k + 1] += scratch.first_of_pair[k];
    }
    scratch.active.resize(static_cast<std::size_t>(scratch.first_of_pair.back()));
    std::fill(scratch.crushing.begin(), scratch.crushing.end(), 0.0);
    for_each_pending([&](Index b, Index a, Reach reach) {
        const Index at = row(tables, b, a);
        const double* limit = scratch.limit.data() + b * stride;
        double crushing = 0.0;
        for (Index c = reach.first; c <= reach.last; ++c) {
            double crushes = pending_[at + c] * (limit[a] * limit[c]);
            if (crushes < negligible_mass) crushes = 0.0;
            pending_[at + c] -= crushes;
            crushing += crushes;
            if (c <= a)
                detail::at(scratch.active, scratch.next_of_pair[pair_of(a, c)]++) = {b, share_[at + c],
                                                                                     crushes};
        }
        scratch.crushing[b * stride + a] = crushing;
    });
}

// A fragment goes on crushing as long as it is active between the same neighbours. With G the shares in which one crush of
// an active node ends, G_b = (f_b (1 - A) + sum over active i < b of f_bi A_i G_i) / (1 - f_bb A_b), and likewise the
// number of crushes on the way.
void TripleState::crush_between_pairs(const TripleTables& tables, TripleScratch& scratch) {
    const Index nodes = tables.nodes();
    const Index stride = tables.stride();
    for (const Index at : scratch.written) std::fill_n(scratch.landed.data() + at, stride, 0.0);
    scratch.written.clear();
    for (Index a = 0; a < nodes; ++a) {
        for (Index b = 0; b < nodes; ++b) {
            if (scratch.crushing[b * stride + a] > 0.0)
                std::fill_n(scratch.beside.data() + (a * nodes + b) * stride, stride, 0.0);
        }
    }
    for (Index a = 0; a < nodes; ++a) {
        for (Index c = 0; c <= a; ++c) {
            const TripleScratch::Active* active =
                scratch.active.data() + scratch.first_of_pair[pair_of(a, c)];
            Index count = scratch.first_of_pair[pair_of(a, c) + 1] - scratch.first_of_pair[pair_of(a, c)];
            while (count > 0 && active[count - 1].crushes <= 0.0) --count;
            if (count == 0) continue;
            double* landed = scratch.landed.data() + (a * nodes + c) * stride;
            scratch.written.push_back((a * nodes + c) * stride);
            for (Index k = 0; k < count; ++k) {
                const Index b = active[k].node;
                const double* once = tables.fragments(b);
                double* outcome = scratch.outcome.data() + k * stride;
                std::copy_n(once, lanes_up(b + 1), outcome);
                for (Index i = 0; i <= k; ++i) outcome[active[i].node] *= 1.0 - active[i].share;
                double crushes = 1.0;
                for (Index i = 0; i < k; ++i) {
                    const Index fragment = active[i].node;
                    const double again = once[fragment] * active[i].share;
                    if (again == 0.0) continue;
                    add_scaled(again, scratch.outcome.data() + i * stride, outcome, fragment + 1);
                    crushes += again * scratch.count[i];
                }
                const double stays = 1.0 / (1.0 - once[b] * active[k].share);
                for (Index i = 0; i <= b; ++i) outcome[i] *= stays;
                scratch.count[k] = crushes * stays;
                if (active[k].crushes <= 0.0) continue;
                add_scaled(active[k].crushes, outcome, landed, b + 1);
                add_scaled(active[k].crushes, outcome, scratch.beside.data() + (a * nodes + b) * stride,
                           b + 1);
                if (c != a)
                    add_scaled(active[k].crushes, outcome, scratch.beside.data() + (c * nodes + b) * stride,
                               b + 1);
                crushes_ += (c != a ? 2.0 : 1.0) * active[k].crushes * scratch.count[k];
            }
            if (c == a) continue;
            std::copy_n(landed, stride, scratch.landed.data() + (c * nodes + a) * stride);
            scratch.written.push_back((c * nodes + a) * stride);
        }
    }
}

// The mass of a centre beside a crushing neighbour is spread over the fragments that it has for a neighbour now.
template <class Mass>
void TripleState::move_neighbours(const TripleTables& tables, Index centre, TripleScratch& scratch,
                                  LaneArray& moved, const Mass& mass) const {
    const Index nodes = tables.nodes();
    const Index stride = tables.stride();
    const Index terms = scratch.columns.size();
    for (Index z = 0; z < nodes; ++z) {
        double* around = scratch.around.data() + z * stride;
        const Index at = row(tables, centre, z);
        for (Index t = 0; t < terms; ++t) around[t] = mass(at + scratch.columns[t]);
    }
    multiply_lower({scratch.around.data(), scratch.columns.data(), scratch.factor.data(), terms, stride},
                   moved.data(), nodes);
    add_transposed(moved.data(), stride, lanes_up(nodes));
}

// The left of two adjacent cells knows nothing of what is right of them: of the centres a beside b, those beside a
// crushing b are a share that does not depend on the other neighbour z.
void TripleState::replace_sides(const TripleTables& tables, TripleScratch& scratch) {
    const Index nodes = tables.nodes();
    const Index stride = tables.stride();
    for (Index a = 0; a < nodes; ++a) {
        scratch.columns.clear();
        std::fill(scratch.leaves.begin(), scratch.leaves.end(), 0.0);
        for (Index b = 1; b < nodes; ++b) {
            const double crushing = scratch.crushing[b * stride + a];
            if (crushing <= 0.0) continue;
            const double keeping = scratch.pairs[a * stride + b] - scratch.crushing[a * stride + b];
            double* factor = scratch.factor.data() + scratch.columns.size() * stride;
            const double* beside = scratch.beside.data() + (a * nodes + b) * stride;
            const double share = 1.0 / keeping;
            for (Index i = 0; i < stride; ++i) factor[i] = beside[i] * share;
            scratch.leaves[b] = crushing * share;
            scratch.columns.push_back(b);
        }
        if (scratch.columns.empty()) continue;
        const bool scattered = !endured_.empty();
        move_neighbours(tables, a, scratch, scratch.moved,
                        [&](Index k) { return settled_[k] + pending_[k]; });
        if (scattered) {
            move_neighbours(tables, a, scratch, scratch.moved_pending, [&](Index k) { return pending_[k]; });
            move_neighbours(tables, a, scratch, scratch.moved_endured, [&](Index k) { return endured_[k]; });
        }
        for (Index z = 0; z < nodes; ++z) {
            const Index at = row(tables, a, z);
            const Reach reach = reach_[a * nodes + z];
            const double* leaves = scratch.leaves.data();
            const auto rest = [&](Index begin, Index end) {
                const auto replace = [&](const LaneArray& moved, LaneArray& in) {
                    replace_neighbours(leaves[z], leaves + begin, moved.data() + z * stride + begin,
                                       in.data() + at + begin, end - begin);
                };
                replace(scratch.moved, settled_);
                if (scattered) replace(scratch.moved_endured, endured_);
            };
            if (reach.empty()) {
                rest(0, nodes);
                continue;
            }
            rest(0, reach.first);
            for (Index b = reach.first; b <= reach.last; ++b) {
                const double stays = 1.0 - (leaves[z] + leaves[b]);
                const Index from = z * stride + b;
                const double arriving = scratch.moved[from];
                Settling settling{(1.0 - share_[at + b]) * arriving, 0.0};
                if (scattered) {
                    const double waiting = scratch.moved_pending[from];
                    settling = settling_of(at + b, arriving - waiting, scratch.moved_endured[from]);
                    endured_[at + b] = endured_[at + b] * stays + settling.endured;
                }
                pending_[at + b] = pending_[at + b] * stays + (arriving - settling.mass);
                settled_[at + b] = settled_[at + b] * stays + settling.mass;
            }
            rest(reach.last + 1, nodes);
        }
    }
}

// Settled cells that have borne a hazard under their earlier neighbours bear it under the new ones too, and only what goes
// beyond it is new to them. Pending cells stay so.
TripleState::Settling TripleState::settling_of(Index at, double arriving, double endured) const {
    if (!(arriving > 0.0)) return {0.0, 0.0};
    const double hazard = hazard_of(share_[at]);
    const double before = endured / arriving;
    const double mass = hazard > before ? arriving * std::exp(before - hazard) : arriving;
    return {mass, mass * std::max(before, own_[at])};
}

void TripleState::settle_landed(const TripleTables& tables, TripleScratch& scratch) {
    const Index nodes = tables.nodes();
    const Index stride = tables.stride();
    for (const Index at : scratch.written) {
        const Index a = at / stride / nodes;
        const Index c = at / stride % nodes;
        const double* landed = scratch.landed.data() + at;
        const Index between = a * stride + c;
        for (Index b = 0; b < nodes; ++b) settled_[between + b * nodes * stride] += landed[b];
        if (endured_.empty()) continue;
        for (Index b = 0; b < nodes; ++b) {
            const Index k = between + b * nodes * stride;
            endured_[k] += landed[b] * own_[k];
        }
    }
}

}  // namespace comminute::detail
