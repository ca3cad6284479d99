// SPDX-License-Identifier: BSD-3-Clause
// Triples with a newcomer (docs/theory/columns.md, section 3).
#pragma once

#include <array>

#include "resolved/triple_state.hpp"
#include "resolved/triple_tables.hpp"
#include "simd/lanes.hpp"

namespace comminute::detail {

/// Kinds of triples by the newcomers among their cells: none, or more than one; the centre; the left neighbour. The last
/// stands for its mirror image too, and counts twice.
constexpr Index kinds = 3;
constexpr Index old_pairs = 0;
constexpr Index new_centre = 1;
constexpr Index new_left = 2;

/// Settled and pending mass of the triples with one newcomer, from an exchange until the row has come to rest. Pairs that
/// have met just now share no history, so that they are not to be taken for the old pairs of the same sizes.
struct FreshPairs {
    explicit FreshPairs(const TripleTables& tables)
        : settled{LaneArray(size(tables)), LaneArray(size(tables))},
          pending{settled},
          half_(lanes_up(tables.nodes()) * tables.stride()),
          turned_(half_.size()) {}

    /// Settled mass of all kinds, the row's own first; the same of pending mass.
    std::array<double*, kinds> settled_of(TripleState& row) {
        return {row.settled().data(), settled[0].data(), settled[1].data()};
    }
    std::array<double*, kinds> pending_of(TripleState& row) {
        return {row.pending().data(), pending[0].data(), pending[1].data()};
    }
    /// Joins the row: its pairs are old now.
    void merge(const TripleTables& tables, TripleState& row);

    std::array<LaneArray, 2> settled;  // (N, N, stride) of a new centre, and of a new left neighbour
    std::array<LaneArray, 2> pending;

  private:
    static Index size(const TripleTables& tables) {
        return tables.nodes() * tables.nodes() * tables.stride();
    }

    LaneArray half_;
    LaneArray turned_;
};

}  // namespace comminute::detail
