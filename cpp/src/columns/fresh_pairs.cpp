// SPDX-License-Identifier: BSD-3-Clause
// Merging of new pairs with old ones (docs/theory/columns.md, section 3).
#include "columns/fresh_pairs.hpp"

#include "simd/loops.hpp"

namespace comminute::detail {

void FreshPairs::merge(const TripleTables& tables, TripleState& row) {
    const Index nodes = tables.nodes();
    const Index stride = tables.stride();
    const auto join = [&](const std::array<LaneArray, 2>& fresh, LaneArray& old) {
        for (Index b = 0; b < nodes; ++b) {
            const Index block = b * nodes * stride;
            const double* centre = fresh[0].data() + block;
            const double* left = fresh[1].data() + block;
            double* to = old.data() + block;
            // Half of what is symmetric and the whole of what is not, and then all of it with its mirror image, so that
            // the sum is symmetric to the bit.
            for (Index k = 0; k < nodes * stride; ++k) half_[k] = 0.5 * (to[k] + centre[k]) + left[k];
            transpose(half_.data(), stride, turned_.data(), stride, lanes_up(nodes));
            for (Index k = 0; k < nodes * stride; ++k) to[k] = half_[k] + turned_[k];
        }
    };
    join(settled, row.settled());
    join(pending, row.pending());
}

}  // namespace comminute::detail
