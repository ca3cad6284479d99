// SPDX-License-Identifier: BSD-3-Clause
// Exchanges of rows that are shifted past each other (docs/theory/columns.md, section 2).
#include "columns/shifted_exchange.hpp"

#include <algorithm>

namespace comminute::detail {

namespace {

/// The law of a row, as it was and with some cells swapped for ones of given sizes, and sums of these over cells.
///
/// A name tells the swapped cells, B the centre, L and R its neighbours; the law with the right neighbour swapped is that
/// with the left one seen in a mirror.
class SwappedLaw {
  public:
    SwappedLaw(const TripleTables& tables, const ArrivalRates& rates, Exchange& exchange,
               const TripleState& row)
        : nodes_(tables.nodes()), stride_(tables.stride()), whole_(nodes_ * nodes_ * stride_) {
        for (LaneArray* law : {&none, &B, &L, &BL, &LR, &BLR}) law->assign(whole_, 0.0);
        exchange.for_each_centre(rates, row, [&](Index b) {
            const Exchange::Newcomers found = exchange.newcomers();
            const auto keep = [&](const double* from, LaneArray& to) {
                std::copy_n(from, nodes_ * stride_, to.data() + b * nodes_ * stride_);
            };
            keep(found.none, none);
            keep(found.centre, B);
            keep(found.left, L);
            keep(found.both, BL);
            keep(found.sides, LR);
            keep(found.all, BLR);
        });
        sum_over_cells();
    }

    Index at(Index b, Index a, Index c) const { return (b * nodes_ + a) * stride_ + c; }
    Index at(Index i, Index j) const { return i * stride_ + j; }

    LaneArray none, B, L, BL, LR, BLR;     // (N, N, stride)
    Array<double> centres;                 // (N) sizes
    LaneArray pairs, sides;                // (N, stride) [b, a] and [a, c]
    Array<double> B_only, L_only;          // (N) summed over all other cells
    LaneArray B_pairs, L_pairs, BL_pairs;  // (N, stride) [b, a], summed over c
    LaneArray L_sides, LR_sides;           // (N, stride) [a, c], summed over b

  private:
    void sum_over_cells() {
        for (Array<double>* sums : {&centres, &B_only, &L_only}) sums->assign(nodes_, 0.0);
        for (LaneArray* sums : {&pairs, &sides, &B_pairs, &L_pairs, &BL_pairs, &L_sides, &LR_sides})
            sums->assign(nodes_ * stride_, 0.0);
        double mass = 0.0;
        for (const double cell : none) mass += cell;
        for (LaneArray* law : {&none, &B, &L, &BL, &LR, &BLR}) {
            for (double& cell : *law) cell /= mass;
        }
        for (Index b = 0; b < nodes_; ++b) {
            for (Index a = 0; a < nodes_; ++a) {
                for (Index c = 0; c < nodes_; ++c) {
                    const Index k = at(b, a, c);
                    centres[b] += none[k];
                    pairs[at(b, a)] += none[k];
                    sides[at(a, c)] += none[k];
                    B_only[b] += B[k];
                    B_pairs[at(b, a)] += B[k];
                    L_only[a] += L[k];
                    L_pairs[at(b, a)] += L[k];
                    L_sides[at(a, c)] += L[k];
                    BL_pairs[at(b, a)] += BL[k];
                    LR_sides[at(a, c)] += LR[k];
                }
            }
        }
    }

    Index nodes_;
    Index stride_;
    Index whole_;
};

// For each set of swapped cells: what has come to these places, times the probability that the partners of the others
// stay. That is their law with these places given, by inclusion and exclusion over the partners that would swap.
void change(const TripleTables& tables, const SwappedLaw& own, const SwappedLaw& partner, TripleState& row,
            FreshPairs& fresh) {
    const Index nodes = tables.nodes();
    const auto settled = fresh.settled_of(row);
    const auto pending = fresh.pending_of(row);
    const SwappedLaw& p = partner;
    for (Index b = 0; b < nodes; ++b) {
        for (Index a = 0; a < nodes; ++a) {
            for (Index c = 0; c < nodes; ++c) {
                const Index k = own.at(b, a, c);
                const Index mirror = own.at(b, c, a);
                const Index ba = own.at(b, a);
                const Index bc = own.at(b, c);
                const Index ac = own.at(a, c);
                const double stays = 1.0 - p.B_only[b] - p.L_only[a] - p.L_only[c] + p.BL_pairs[ba] +
                                     p.BL_pairs[bc] + p.LR_sides[ac] - p.BLR[k];
                const double sides_stay = p.centres[b] - p.L_pairs[ba] - p.L_pairs[bc] + p.LR[k];
                const double others_stay =
                    p.centres[a] - p.B_pairs[ba] - p.L_sides[own.at(c, a)] + p.BL[mirror];
                const double right_stays = p.pairs[ba] - p.L[mirror];
                const double left_stays = p.pairs[bc] - p.L[k];
                const double centre_stays = p.sides[ac] - p.B[k];
                const double several = own.BL[k] * right_stays + own.BL[mirror] * left_stays +
                                       own.LR[k] * centre_stays + own.BLR[k] * p.none[k];
                const double active = row.share()[k];
                const auto put = [&](Index kind, double mass) {
                    settled[static_cast<std::size_t>(kind)][k] = (1.0 - active) * mass;
                    pending[static_cast<std::size_t>(kind)][k] = active * mass;
                };
                settled[0][k] = settled[0][k] * stays + (1.0 - active) * several;
                pending[0][k] = pending[0][k] * stays + active * several;
                put(new_centre, own.B[k] * sides_stay);
                put(new_left, own.L[k] * others_stay);
            }
        }
    }
}

}  // namespace

void exchange_shifted(const TripleTables& tables, const std::vector<double>& sizes, Swaps swaps,
                      Exchange& exchange, TripleState& lower, FreshPairs& lower_fresh, TripleState& upper,
                      FreshPairs& upper_fresh) {
    const std::vector<double> any(sizes.size(),
                                  1.0);  // each size with its probability, whatever there is of it
    const SwappedLaw below(tables, ArrivalRates(sizes, {swaps, true, any.data()}), exchange, lower);
    const SwappedLaw above(tables, ArrivalRates(sizes, {swaps, false, any.data()}), exchange, upper);
    change(tables, below, above, lower, lower_fresh);
    change(tables, above, below, upper, upper_fresh);
}

}  // namespace comminute::detail
