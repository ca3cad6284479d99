// SPDX-License-Identifier: BSD-3-Clause
// Memory of material points (docs/guides/material_points.md).
#pragma once

#include "comminute/material_points.hpp"
#include "simd/lanes.hpp"

namespace comminute::detail {

/// Equal blocks of numbers, each of which belongs to one state of a point. Blocks that are given back serve again, so that
/// memory grows with the largest number of blocks in use at once and with nothing else.
class PointStore {
  public:
    /// @param size  numbers in a block
    PointStore(PointNumbers numbers, Index size) : numbers_(numbers), size_(size) {}

    /// Takes a block, with any content.
    Index take();
    void give_back(Index block) { free_.push_back(block); }

    /// The numbers of a block where they are doubles; null where they are not.
    double* doubles(Index block) {
        return numbers_ == PointNumbers::float64 ? doubles_[block].data() : nullptr;
    }
    const double* doubles(Index block) const {
        return numbers_ == PointNumbers::float64 ? doubles_[block].data() : nullptr;
    }
    const float* singles(Index block) const { return singles_[block].data(); }
    void read(Index block, double* to) const;
    void write(const double* from, Index block);

    Index size() const { return size_; }
    std::size_t memory() const;

  private:
    PointNumbers numbers_;
    Index size_;
    Array<LaneArray> doubles_;
    Array<Array<float>> singles_;
    Array<Index> free_;
};

}  // namespace comminute::detail
