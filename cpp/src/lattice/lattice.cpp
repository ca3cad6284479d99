// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>
#include <typeinfo>
#include <utility>

#include "base/check.hpp"
#include "base/random.hpp"
#include "base/workers.hpp"
#include "lattice/crush.hpp"
#include "lattice/rings.hpp"
#include "lattice/weakest_first.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr double largest_log_ratio = 700.0;  // e^700 is close to the largest double

void require_options(const LatticeOptions& options) {
    require(options.replicas >= 1, "replicas", static_cast<double>(options.replicas), "at least 1");
    require(options.threads >= 1, "threads", static_cast<double>(options.threads), "at least 1");
}

void require_cells(Index cells) {
    require(cells >= 2 && cells < 0xFFFFFFFF, "cells", static_cast<double>(cells),
            "at least 2 (a ring) and less than 2^32 - 1");
}

/// The different numbers among many, as long as they are few.
class FewSizes {
  public:
    void add(double size) {
        if (sizes_.size() > most) return;
        const auto place = std::lower_bound(sizes_.begin(), sizes_.end(), size);
        if (place == sizes_.end() || *place != size) sizes_.insert(place, size);
    }
    /// Ascending; none where there are more than 16.
    std::vector<double> found() const { return sizes_.size() > most ? std::vector<double>{} : sizes_; }

  private:
    static constexpr std::size_t most = 16;
    std::vector<double> sizes_;
};

double relative_psi(double size, double reference_size) {
    const double psi = std::log(size / reference_size);
    if (std::abs(psi) <= largest_log_ratio) return psi;
    throw ParameterError({.parameter = "size",
                          .value = text(size),
                          .number = size,
                          .subject = "a size",
                          .finding = "is " + text(size) + " and reference_size is " + text(reference_size),
                          .rule = "their ratio must be between e^-700 and e^700"});
}

LatticeRing ring_of(Index cells, Index replica, std::uint64_t seed) {
    LatticeRing ring;
    ring.cells.resize(static_cast<std::size_t>(cells));
    ring.crushes.assign(ring.cells.size(), 0);
    ring.stream = random_bits(seed, Purpose::stream, static_cast<std::uint64_t>(replica), 0);
    return ring;
}

void shuffle(LatticeRing& ring) {
    for (std::uint64_t left = ring.cells.size(); left > 1; --left) {
        // the high half of a 64 by 64 bit product: as good as uniform, off by less than 2^-31
        const auto bits = random_bits(ring.stream, Purpose::shuffle, left, ring.remixes);
        __extension__ const auto other =
            static_cast<std::size_t>((static_cast<unsigned __int128>(bits) * left) >> 64);
        std::swap(ring.cells[left - 1], ring.cells[other]);
        std::swap(ring.crushes[left - 1], ring.crushes[other]);
        if (!ring.log_strength.empty()) std::swap(ring.log_strength[left - 1], ring.log_strength[other]);
    }
}

void draw_strengths(LatticeRing& ring, const Material& material) {
    if (!material.strength_scatter) return;
    ring.log_strength.resize(ring.cells.size());
    for (std::size_t c = 0; c < ring.cells.size(); ++c) {
        const double uniform = random_uniform(ring.stream, Purpose::first_strength, c, 0);
        ring.log_strength[c] = log_strength(uniform, material.weibull_modulus);
    }
}

}  // namespace

LatticeRing detail::sampled_ring(Index cells, Index replica, const Grading& grading, const Material& material,
                                 std::uint64_t seed) {
    require_cells(cells);
    relative_psi(grading.largest(), material.reference_size);
    const auto* points = std::get_if<PointMasses>(&grading.law);
    const bool one_size = points != nullptr && points->size.size() == 1;
    LatticeRing ring = ring_of(cells, replica, seed);
    for (std::size_t c = 0; c < ring.cells.size(); ++c) {
        const double p = one_size ? 0.5 : random_uniform(ring.stream, Purpose::start, c, 0);
        // tails that run on for ever end where a double does
        const double size = std::max(grading.quantile(p), material.reference_size * 1e-300);
        ring.cells[c] = LatticeCell::of(relative_psi(size, material.reference_size));
    }
    draw_strengths(ring, material);
    return ring;
}

LatticeRing detail::ring_of_sizes(VectorView<const double> sizes, Index replica, const Material& material,
                                  std::uint64_t seed) {
    require_cells(sizes.size());
    LatticeRing ring = ring_of(sizes.size(), replica, seed);
    for (Index c = 0; c < sizes.size(); ++c) {
        if (!(sizes[c] > 0.0 && std::isfinite(sizes[c]))) {
            throw ParameterError({.parameter = "sizes",
                                  .value = text(sizes[c]),
                                  .number = sizes[c],
                                  .rule = "it must be greater than 0 and finite",
                                  .place = {entry("sizes", {c})}});
        }
        ring.cells[static_cast<std::size_t>(c)] =
            LatticeCell::of(relative_psi(sizes[c], material.reference_size));
    }
    draw_strengths(ring, material);
    return ring;
}

LatticeState::LatticeState(Index cells, Material material, const Grading& grading,
                           const LatticeOptions& options)
    : material_(std::move(material)), options_(options) {
    material_.validate();
    require_options(options);
    require_cells(cells);
    relative_psi(grading.largest(), material_.reference_size);
    const auto* points = std::get_if<PointMasses>(&grading.law);
    rings_.resize(static_cast<std::size_t>(options.replicas));
    for_each_ring(
        [&](LatticeRing& ring, const auto&) {
            ring = sampled_ring(cells, &ring - rings_.data(), grading, material_, options_.seed);
        },
        {});
    note_sizes(points != nullptr ? points->size : std::vector<double>{});
}

LatticeState::LatticeState(VectorView<const double> sizes, Material material, const LatticeOptions& options)
    : material_(std::move(material)), options_(options) {
    material_.validate();
    require_options(options);
    for (Index replica = 0; replica < options.replicas; ++replica)
        rings_.push_back(ring_of_sizes(sizes, replica, material_, options_.seed));
    FewSizes few;
    for (const double size : sizes) few.add(size);
    note_sizes(few.found());
}

LatticeState::LatticeState(std::vector<LatticeRing> rings, Material material, const LatticeOptions& options)
    : material_(std::move(material)), options_(options), rings_(std::move(rings)) {
    material_.validate();
    require_options(options);
    require(static_cast<Index>(rings_.size()) == options.replicas, "replicas",
            static_cast<double>(options.replicas), "the number of rings");
    for (const auto& ring : rings_) {
        require_cells(static_cast<Index>(ring.cells.size()));
        const std::size_t strengths = material_.strength_scatter ? ring.cells.size() : 0;
        if (ring.cells.size() != rings_.front().cells.size() || ring.crushes.size() != ring.cells.size() ||
            ring.log_strength.size() != strengths) {
            throw ShapeError({.parameter = "rings",
                              .subject = "the rings",
                              .finding = "differ in length",
                              .rule = "all must have the same number of cells, of crush counts and, where "
                                      "strengths scatter, of strengths"});
        }
    }
    FewSizes sizes;
    for (const auto& ring : rings_) {
        for (std::size_t c = 0; c < ring.cells.size(); ++c) {
            if (ring.crushes[c] == 0) sizes.add(material_.reference_size * std::exp(ring.cells[c].psi));
        }
    }
    note_sizes(sizes.found());
}

void LatticeState::note_sizes(const std::vector<double>& exact) {
    double top = -largest_log_ratio;
    for (const auto& ring : rings_) {
        for (const auto& cell : ring.cells) top = std::max(top, cell.psi);
    }
    largest_ = material_.reference_size * std::exp(top);
    for (const double size : exact) {
        const double psi = relative_psi(size, material_.reference_size);
        exact_.push_back({psi, 0.0, size});
        if (psi == top) largest_ = size;
    }
}

void LatticeState::for_each_ring(const std::function<void(LatticeRing&, const std::function<bool()>&)>& work,
                                 const std::function<bool()>& go_on) {
    for_each_index(
        rings_.size(), static_cast<std::size_t>(options_.threads),
        [&](std::size_t r, const std::function<bool()>& ask) { work(rings_[r], ask); }, go_on);
}

void LatticeState::require_load(double stress_ratio) const {
    require_stress_ratio(stress_ratio);
    const double largest = 3.0 / material_.weibull_modulus * largest_log_ratio;
    if (std::log(stress_ratio) <= largest) return;
    throw ParameterError(
        {.parameter = "stress_ratio",
         .value = text(stress_ratio),
         .number = stress_ratio,
         .rule = "it must be at most e^" + text(largest) +
                 ": more crushes grains below e^-700 of reference_size, which a double cannot hold"});
}

std::uint64_t LatticeState::total_crushes() const {
    std::uint64_t total = 0;
    for (const auto& ring : rings_) total = std::accumulate(ring.crushes.begin(), ring.crushes.end(), total);
    return total;
}

std::uint64_t LatticeState::load_to(double stress_ratio, const std::function<bool()>& go_on) {
    require_load(stress_ratio);
    const auto before = total_crushes();
    if (come_to_rest(go_on)) {
        for (auto& ring : rings_) {
            if (ring.loaded_to && stress_ratio <= *ring.loaded_to) continue;
            ring.loaded_to = stress_ratio;
            ring.at_rest = false;
        }
        come_to_rest(go_on);
    }
    return total_crushes() - before;
}

bool LatticeState::come_to_rest(const std::function<bool()>& go_on) {
    const auto at_rest = [](const LatticeRing& ring) { return ring.at_rest; };
    if (std::all_of(rings_.begin(), rings_.end(), at_rest)) return true;
    for_each_ring(
        [&](LatticeRing& ring, const std::function<bool()>& ask) {
            if (!ring.at_rest) ring.at_rest = load_ring(ring, *ring.loaded_to, ask);
        },
        go_on);
    return std::all_of(rings_.begin(), rings_.end(), at_rest);
}

std::optional<double> LatticeState::settled_at() const {
    std::optional<double> least = rings_.front().loaded_to;
    for (const auto& ring : rings_) {
        if (!ring.loaded_to || !ring.at_rest) return std::nullopt;
        least = std::min(least, ring.loaded_to);
    }
    return least;
}

void LatticeState::remix() {
    for_each_ring(
        [](LatticeRing& ring, const auto&) {
            ++ring.remixes;
            shuffle(ring);
            ring.loaded_to.reset();
            ring.at_rest = true;
            ring.stepped_to = 0.0;
            ring.avalanches_in_order = ring.avalanches.size();
        },
        {});
}

bool operator==(const LatticeState& a, const LatticeState& b) {
    const auto known = [](const LatticeRing& r) {
        return std::tie(r.cells, r.crushes, r.log_strength, r.stream, r.remixes, r.passes, r.loaded_to,
                        r.at_rest, r.stepped_to, r.avalanches, r.avalanches_in_order);
    };
    return typeid(a) == typeid(b) && a.material_ == b.material_ && a.options_.seed == b.options_.seed &&
           a.options_.mean == b.options_.mean &&
           a.options_.record_avalanches == b.options_.record_avalanches &&
           std::equal(a.rings_.begin(), a.rings_.end(), b.rings_.begin(), b.rings_.end(),
                      [&](const LatticeRing& x, const LatticeRing& y) { return known(x) == known(y); });
}

Lattice::Lattice(Index cells, const Material& material, const Grading& grading, const LatticeOptions& options)
    : LatticeState(cells, material, grading, options) {}

Lattice::Lattice(VectorView<const double> sizes, const Material& material, const LatticeOptions& options)
    : LatticeState(sizes, material, options) {}

Lattice::Lattice(std::vector<LatticeRing> rings, const Material& material, const LatticeOptions& options)
    : LatticeState(std::move(rings), material, options) {}

bool Lattice::load_ring(LatticeRing& ring, double stress_ratio, const std::function<bool()>& go_on) const {
    return crush_weakest_first(ring, material(), options().mean, stress_ratio, options().record_avalanches,
                               go_on);
}

const std::vector<Avalanche>& Lattice::avalanches(Index replica) const {
    if (!options().record_avalanches) {
        throw ParameterError({.parameter = "record_avalanches",
                              .value = "false",
                              .subject = "avalanches",
                              .finding = "were not recorded",
                              .remedy = Remedy::record_avalanches});
    }
    return rings()[checked(replica)].avalanches;
}

}  // namespace comminute
