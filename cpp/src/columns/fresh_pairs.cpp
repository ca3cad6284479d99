// SPDX-License-Identifier: BSD-3-Clause
#include "columns/fresh_pairs.hpp"

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
            for (Index a = 0; a < nodes; ++a) {
                for (Index c = 0; c <= a; ++c) {
                    const double sides = left[a * stride + c] + left[c * stride + a];
                    const double all = to[a * stride + c] + (centre[a * stride + c] + sides);
                    to[a * stride + c] = to[c * stride + a] = all;
                }
            }
        }
    };
    join(settled, row.settled());
    join(pending, row.pending());
}

}  // namespace comminute::detail
