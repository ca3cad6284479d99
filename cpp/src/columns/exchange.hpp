// SPDX-License-Identifier: BSD-3-Clause
// Grains of a row that change places with those of another, by the law of three cells (docs/theory/columns.md, section 2).
#pragma once

#include <vector>

#include "columns/fresh_pairs.hpp"
#include "resolved/triple_state.hpp"
#include "resolved/triple_tables.hpp"
#include "simd/lanes.hpp"
#include "simd/transport.hpp"

namespace comminute::detail {

/// Probability that a grain of a row changes places with one of the row above.
struct Swaps {
    double mixing = 0.0;  ///< whatever their sizes
    double segregation =
        0.0;  ///< Q for a unit of size by which the lower grain is the larger; adds Q - Q^2 / 2
};

/// Grains that may come to a row in one exchange.
struct Arrivals {
    Swaps swaps;
    bool lower = true;                ///< whether the row is the lower one of its bond
    const double* partner = nullptr;  ///< (N) shares of the other row, sum 1; null for a row without a bond
    double renewal = 0.0;             ///< share of the cells that meet another grain of their own row
    const double* own = nullptr;      ///< (N) shares of the row itself, sum 1
};

/// Probabilities by size of an exchange: of a grain that comes to a place, and of one that stays in its own.
class ArrivalRates {
  public:
    ArrivalRates(const std::vector<double>& sizes, const Arrivals& arrivals);

    /// (N) share of the grains of each size that stay.
    const double* stays() const { return stays_.data(); }
    /// (N) arrivals of each size.
    const ArrivalRow* rows() const { return rows_.data(); }
    /// (N) sizes as their sums go.
    const Array<Index>& order() const { return order_; }

  private:
    Array<ArrivalRow> rows_;
    Array<Index> order_;
    LaneArray stays_;
};

/// Exchanges of one thread, with their working memory.
class Exchange {
  public:
    explicit Exchange(const TripleTables& tables);

    /// Every cell of the row has another partner: newcomers are independent of each other. What has had a newcomer alone goes
    /// to `fresh`; what stays keeps its settled and its pending mass.
    void permuted(const ArrivalRates& rates, TripleState& row, FreshPairs& fresh);

    /// Calls visit(b) for each centre once newcomers() are its own, from the law as it was. The row may be changed at that
    /// centre, since the sums over sizes have passed it.
    template <class Visit>
    void for_each_centre(const ArrivalRates& rates, const TripleState& row, const Visit& visit);

    /// (N, stride) the law of one centre, and the same with some of its cells replaced.
    struct Newcomers {
        const double* none;
        const double* centre;
        const double* left;
        const double* both;         ///< the centre and the left neighbour
        const double* both_turned;  ///< the centre and the right neighbour
        const double* sides;        ///< both neighbours
        const double* all;
    };
    Newcomers newcomers() const {
        return {cells_.data(),       centre_.data(), left_.data(), both_.data(),
                both_turned_.data(), sides_.data(),  all_.data()};
    }

  private:
    Index block() const { return nodes_ * stride_; }
    void sum_centres(const TripleState& row);
    void add_pending(const TripleState& row, Index b, double* to) const;
    void replace(const ArrivalRates& rates, const TripleState& row, Index b);
    void replace_left(const ArrivalRates& rates, const double* from, double* to);
    void turn(const double* from, double* to) const;

    const TripleTables& tables_;
    Index nodes_;
    Index stride_;
    LaneArray total_;        // (N, stride) mass of all centres
    LaneArray centre_sums_;  // (3, N, stride)
    LaneArray left_sums_;    // (4, stride)
    LaneArray cells_;        // (N, stride) one centre before
    LaneArray turned_;       // the same, its neighbours exchanged
    LaneArray centre_;       // with a new centre
    LaneArray left_;         // with a new left neighbour
    LaneArray both_;
    LaneArray both_turned_;
    LaneArray sides_;
    LaneArray all_;
};

template <class Visit>
void Exchange::for_each_centre(const ArrivalRates& rates, const TripleState& row, const Visit& visit) {
    sum_centres(row);
    for (const Index b : rates.order()) {
        replace(rates, row, b);
        visit(b);
    }
}

}  // namespace comminute::detail
