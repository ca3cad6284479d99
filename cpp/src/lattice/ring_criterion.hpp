// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/random.hpp"
#include "comminute/lattice.hpp"
#include "lattice/crush.hpp"

namespace comminute::detail {

/// ln(stress ratio) of the closed crush test: raised by a few units in the last place, so that a cell exactly at
/// its critical load crushes however that was rounded.
double closed_log_load(const LatticeRing& ring, const Material& material, double stress_ratio);

/// ln of a cell's own factor of its critical load; 0 unless strengths scatter.
inline double log_strength_of(const LatticeRing& ring, std::uint32_t cell) {
    return ring.log_strength.empty() ? 0.0 : ring.log_strength[cell];
}

/// ln(size / reference size) of the largest cell.
double largest_psi(const LatticeRing& ring);

/// Log size of the neighbourhood of two cells, relative to the reference size (Eq. 48 or 65).
inline double neighbourhood(const LatticeCell& left, const LatticeCell& right, Mean mean) {
    if (mean == Mean::geometric) return 0.5 * (left.psi + right.psi);
    const double size = 0.5 * (left.size + right.size);
    if (size > 1e-290) return std::log(size);
    const double larger = std::max(left.psi, right.psi);  // sizes that a double cannot hold
    return larger + std::log1p(std::exp(std::min(left.psi, right.psi) - larger)) - std::log(2.0);
}

/// Up to where a ring is to be loaded, and the crush test of Eq. 2 against it, in logs.
///
/// Besides the load there is a tie key: cells of equal critical load crush in the order of random keys. A cell's own factor
/// of its critical load changes only when it crushes, so that a barrier may count on it.
class LoadLimit {
  public:
    enum class Look {
        barrier,  ///< cannot crush up to this limit, whatever becomes of its neighbours
        dormant,  ///< does not crush as things are, but would if its larger neighbours got smaller
        active,   ///< crushes
    };

    /// @param largest_psi  no cell of the ring is larger
    LoadLimit(const Material& material, Mean mean, double largest_psi, double log_load,
              std::uint64_t tie_key = std::numeric_limits<std::uint64_t>::max())
        : mean_(mean),
          strength_(3.0 / material.weibull_modulus),
          width_(material.fabric_width),
          largest_psi_(largest_psi),
          weakest_(material.strength_scatter ? least_log_strength(material.weibull_modulus) : 0.0),
          tie_key_(tie_key) {
        set(log_load, tie_key);
    }

    void set(double log_load, std::uint64_t tie_key) {
        log_load_ = log_load;
        tie_key_ = tie_key;
        // Beyond this difference of log sizes the largest cell does not crush, were it the weakest, and smaller ones even
        // less. The margin leaves the decision about doubtful cells to the full test.
        const double cushion = std::max(log_load_ + strength_ * largest_psi_ - weakest_, 0.0);
        const double reach = width_ * std::sqrt(2.0 * cushion) * (1.0 + 1e-9) + 1e-9;
        grow_ = std::exp(reach);
        shrink_ = std::exp(-reach);
    }

    double log_load() const { return log_load_; }
    std::uint64_t tie_key() const { return tie_key_; }

    /// Prospect of a cell; `critical` is set to the log of its critical stress ratio if it is active.
    /// @param log_strength  ln of the cell's own factor of its critical load
    template <class TieKey>
    Look look(const LatticeCell& left, const LatticeCell& cell, const LatticeCell& right, double log_strength,
              const TieKey& tie_key, double& critical) const {
        critical = log_strength - strength_ * cell.psi;
        if (critical > log_load_) return Look::barrier;
        double contrast = 0.0;
        if (width_ < std::numeric_limits<double>::infinity()) {
            // Neighbours only get smaller. So a cell among smaller ones only gets stronger, and one among larger
            // ones is at best as weak as among equals.
            if (mean_ == Mean::arithmetic) {
                const double size = 0.5 * (left.size + right.size);
                if (size < cell.size * shrink_) return Look::barrier;
                if (size > cell.size * grow_) return Look::dormant;
            }
            contrast = cell.psi - neighbourhood(left, right, mean_);
            const double scaled = contrast / width_;
            critical += 0.5 * scaled * scaled;
        }
        if (critical < log_load_ || (critical == log_load_ && tie_key() <= tie_key_)) return Look::active;
        return contrast >= 0.0 ? Look::barrier : Look::dormant;
    }

  private:
    Mean mean_;
    double strength_;
    double width_;
    double largest_psi_;
    double weakest_;  // least log_strength
    double log_load_ = 0.0;
    std::uint64_t tie_key_;
    double grow_ = 0.0;
    double shrink_ = 0.0;
};

}  // namespace comminute::detail
