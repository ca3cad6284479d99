// SPDX-License-Identifier: BSD-3-Clause
#include "columns/exchange.hpp"

#include <algorithm>
#include <cmath>

#include "simd/loops.hpp"

namespace comminute::detail {

ArrivalRates::ArrivalRates(const std::vector<double>& sizes, const Arrivals& arrivals)
    : sizes_(sizes),
      lower_(arrivals.lower),
      any_(static_cast<Index>(sizes.size())),
      linear_(any_.size()),
      square_(any_.size()),
      stays_(row_stride(any_.size())) {
    const Index nodes = any_.size();
    const double q = arrivals.swaps.segregation;
    for (Index x = 0; x < nodes; ++x) {
        if (arrivals.partner) {
            any_[x] = arrivals.swaps.mixing * arrivals.partner[x];
            linear_[x] = q * arrivals.partner[x];
            square_[x] = 0.5 * q * q * arrivals.partner[x];
        }
        if (arrivals.renewal > 0.0) any_[x] += arrivals.renewal * arrivals.own[x];
    }
    // A grain of one size in place of another of the same size changes nothing.
    for (Index y = 0; y < nodes; ++y) {
        double leaves = 0.0;
        for (Index x = 0; x < nodes; ++x) {
            if (x != y) leaves += any_[x];
            const double distance = lower_ ? at(sizes_, y) - at(sizes_, x) : at(sizes_, x) - at(sizes_, y);
            if (distance > 0.0) leaves += distance * (linear_[x] - square_[x] * distance);
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
      left_total_(stride_),
      left_sums_(3 * stride_),
      cells_(block()),
      turned_(lanes_up(nodes_) * stride_),
      centre_(block()),
      left_(turned_.size()),
      both_(turned_.size()),
      both_turned_(turned_.size()),
      sides_(turned_.size()),
      all_(turned_.size()) {}

void Exchange::replace_left(const ArrivalRates& rates, const double* from, double* to) {
    std::fill(left_total_.begin(), left_total_.end(), 0.0);
    std::fill(left_sums_.begin(), left_sums_.end(), 0.0);
    for (Index a = 0; a < nodes_; ++a) add_scaled(1.0, from + a * stride_, left_total_.data(), stride_);
    const SizeSums sums{left_sums_.data(), left_sums_.data() + stride_, left_sums_.data() + 2 * stride_};
    rates.for_each_size([&](Index a, double step) {
        arrive(rates.row(a, step, from + a * stride_, left_total_.data()), sums, to + a * stride_, stride_);
    });
}

void Exchange::turn(const double* from, double* to) const {
    for (Index r = 0; r < nodes_; r += lanes) {
        for (Index c = 0; c < nodes_; c += lanes)
            transpose(from + r * stride_ + c, stride_, to + c * stride_ + r, stride_);
    }
}

void Exchange::sum_centres(const TripleState& row) {
    std::fill(total_.begin(), total_.end(), 0.0);
    std::fill(centre_sums_.begin(), centre_sums_.end(), 0.0);
    for (Index b = 0; b < nodes_; ++b) {
        add_scaled(1.0, row.settled().data() + b * block(), total_.data(), block());
        add_scaled(1.0, row.pending().data() + b * block(), total_.data(), block());
    }
}

void Exchange::replace(const ArrivalRates& rates, const TripleState& row, Index b, double step) {
    const SizeSums sums{centre_sums_.data(), centre_sums_.data() + block(),
                        centre_sums_.data() + 2 * block()};
    std::copy_n(row.settled().data() + b * block(), block(), cells_.data());
    add_scaled(1.0, row.pending().data() + b * block(), cells_.data(), block());
    arrive(rates.row(b, step, cells_.data(), total_.data()), sums, centre_.data(), block());
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
    const double* stays = rates.stays();
    for_each_centre(rates, row, [&](Index b) {
        for (Index a = 0; a < nodes_; ++a) {
            const Index in = a * stride_;
            const Index to = b * block() + in;
            exchange_row({stays,
                          stays[b],
                          stays[a],
                          row.share().data() + to,
                          centre_.data() + in,
                          left_.data() + in,
                          both_.data() + in,
                          both_turned_.data() + in,
                          sides_.data() + in,
                          all_.data() + in,
                          {settled[0] + to, settled[1] + to, settled[2] + to},
                          {pending[0] + to, pending[1] + to, pending[2] + to}},
                         nodes_);
        }
    });
}

}  // namespace comminute::detail
