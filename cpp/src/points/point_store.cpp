// SPDX-License-Identifier: BSD-3-Clause
// Blocks, taken and given back (docs/guides/material_points.md).
#include "points/point_store.hpp"

#include <algorithm>

namespace comminute::detail {

Index PointStore::take() {
    if (!free_.empty()) {
        const Index block = free_.back();
        free_.resize(free_.size() - 1);
        return block;
    }
    const bool wide = numbers_ == PointNumbers::float64;
    if (wide) {
        doubles_.push_back(LaneArray(size_));
    } else {
        singles_.push_back(Array<float>(size_));
    }
    const Index blocks = wide ? doubles_.size() : singles_.size();
    free_.reserve(std::max(blocks, 2 * free_.size()));  // to give all of them back costs no memory
    return blocks - 1;
}

void PointStore::read(Index block, double* to) const {
    if (const double* const from = doubles(block)) {
        std::copy_n(from, size_, to);
    } else {
        std::copy(singles_[block].begin(), singles_[block].end(), to);
    }
}

void PointStore::write(const double* from, Index block) {
    if (double* const to = doubles(block)) {
        std::copy_n(from, size_, to);
    } else {
        std::transform(from, from + size_, singles_[block].begin(),
                       [](double number) { return static_cast<float>(number); });
    }
}

std::size_t PointStore::memory() const {
    const auto numbers = static_cast<std::size_t>(size_);
    return static_cast<std::size_t>(doubles_.size()) * numbers * sizeof(double) +
           static_cast<std::size_t>(singles_.size()) * numbers * sizeof(float);
}

}  // namespace comminute::detail
