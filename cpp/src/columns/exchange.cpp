// SPDX-License-Identifier: BSD-3-Clause
// Exchanges with a partner for every cell (docs/theory/columns.md, section 2).
#include "columns/exchange.hpp"

#include <algorithm>
#include <cmath>

#include "simd/loops.hpp"

namespace comminute::detail {

ArrivalRates::ArrivalRates(const std::vector<double>& sizes, const Arrivals& arrivals)
    : rows_(static_cast<Index>(sizes.size())), stays_(row_stride(rows_.size())) {
    const Index nodes = rows_.size();
    const double q = arrivals.swaps.segregation;
    for (Index k = 0; k < nodes; ++k) {
        const Index x = arrivals.lower ? nodes - 1 - k : k;
        ArrivalRow& row = rows_[x];
        const double share = arrivals.partner ? arrivals.partner[x] : 0.0;
        row = {0.0, arrivals.swaps.mixing * share, q * share, 0.5 * q * q * share,
               arrivals.partner && q > 0.0};
        if (k > 0) row.step = std::abs(at(sizes, x) - at(sizes, order_.back()));
        if (arrivals.renewal > 0.0) row.any += arrivals.renewal * arrivals.own[x];
        order_.push_back(x);
    }
    // A grain of one size in place of another of the same size changes nothing.
    for (Index y = 0; y < nodes; ++y) {
        double leaves = 0.0;
        for (Index x = 0; x < nodes; ++x) {
            if (x != y) leaves += rows_[x].any;
            const double distance =
                arrivals.lower ? at(sizes, y) - at(sizes, x) : at(sizes, x) - at(sizes, y);
            if (distance > 0.0) leaves += distance * (rows_[x].linear - rows_[x].square * distance);
        }
        stays_[y] = 1.0 - leaves;
    }
}

Exchange::Exchange(const TripleTables& tables)
    : tables_(tables),
      nodes_(tables.nodes()),
      stride_(tables.stride()),
      total_(block()),
      centre_sums_(3 * block()),
      left_sums_(4 * stride_),
      cells_(block()),
      turned_(lanes_up(nodes_) * stride_),
      centre_(block()),
      left_(turned_.size()),
      both_(turned_.size()),
      both_turned_(turned_.size()),
      sides_(turned_.size()),
      all_(turned_.size()) {}

void Exchange::replace_left(const ArrivalRates& rates, const double* from, double* to) {
    arrive_rows(rates.rows(), rates.order().data(), from, left_sums_.data(), to, nodes_, stride_);
}

void Exchange::turn(const double* from, double* to) const {
    transpose(from, stride_, to, stride_, lanes_up(nodes_));
}

void Exchange::sum_centres(const TripleState& row) {
    std::fill(total_.begin(), total_.end(), 0.0);
    std::fill(centre_sums_.begin(), centre_sums_.end(), 0.0);
    for (Index b = 0; b < nodes_; ++b) {
        add_scaled(1.0, row.settled().data() + b * block(), total_.data(), block());
        add_pending(row, b, total_.data());
    }
}

void Exchange::add_pending(const TripleState& row, Index b, double* to) const {
    for (Index a = 0; a < nodes_; ++a) {
        const Reach reach = row.reach(tables_, b, a);
        const double* pending = row.pending().data() + b * block() + a * stride_;
        for (Index c = reach.first; c <= reach.last; ++c) to[a * stride_ + c] += pending[c];
    }
}

void Exchange::replace(const ArrivalRates& rates, const TripleState& row, Index b) {
    const SizeSums sums{centre_sums_.data(), centre_sums_.data() + block(),
                        centre_sums_.data() + 2 * block()};
    std::copy_n(row.settled().data() + b * block(), block(), cells_.data());
    add_pending(row, b, cells_.data());
    arrive(rates.rows()[b], cells_.data(), total_.data(), sums, centre_.data(), block());
    replace_left(rates, cells_.data(), left_.data());
    replace_left(rates, centre_.data(), both_.data());
    turn(left_.data(), turned_.data());
    replace_left(rates, turned_.data(), sides_.data());
    turn(both_.data(), both_turned_.data());
    replace_left(rates, both_turned_.data(), all_.data());
}

void Exchange::permuted(const ArrivalRates& rates, TripleState& row, FreshPairs& fresh) {
    const auto settled = fresh.settled_of(row);
    const auto pending = fresh.pending_of(row);
    for_each_centre(rates, row, [&](Index b) {
        const Index to = b * block();
        exchange_centre({rates.stays(),
                         rates.stays()[b],
                         row.share().data() + to,
                         centre_.data(),
                         left_.data(),
                         both_.data(),
                         both_turned_.data(),
                         sides_.data(),
                         all_.data(),
                         {settled[0] + to, settled[1] + to, settled[2] + to},
                         {pending[0] + to, pending[1] + to, pending[2] + to}},
                        nodes_, stride_);
    });
}

}  // namespace comminute::detail
