// SPDX-License-Identifier: BSD-3-Clause
// Columns of a response table and how they are read (docs/theory/response_tables.md).
#include "points/response_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/point_curve.hpp"

namespace comminute::detail {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A number and its derivative by ln(stress ratio).
struct Dual {
    double value;
    double slope;

    friend Dual operator+(Dual a, Dual b) { return {a.value + b.value, a.slope + b.slope}; }
    friend Dual operator-(Dual a, Dual b) { return {a.value - b.value, a.slope - b.slope}; }
    friend Dual operator*(double a, Dual b) { return {a * b.value, a * b.slope}; }
    friend Dual larger(Dual a, Dual b) { return a.value < b.value ? b : a; }
    friend Dual smaller(Dual a, Dual b) { return b.value < a.value ? b : a; }
};

/// Log size at which a curve that is even between two sizes has a share.
Dual crossing(double share, double low, Dual finer_low, double high, Dual finer_high) {
    const Dual rise = finer_high - finer_low;
    if (!(rise.value > 0.0)) return {high, 0.0};
    const double part = std::clamp((share - finer_low.value) / rise.value, 0.0, 1.0);
    const double slope = -(finer_low.slope + part * rise.slope) / rise.value;
    return {low + part * (high - low), slope * (high - low)};
}

}  // namespace

ResponseData::ResponseData(const LogGrid& of_grid, const ResponseOptions& of_options, double of_largest,
                           double of_most, const std::vector<PointMass>& of_start)
    : grid(of_grid), options(of_options), largest(of_largest), most(of_most) {
    for (const PointMass& point : of_start) {
        exact.push_back({point.psi, 0.0, point.size});
        exact_bin.push_back(grid.bin_of(point.psi));
    }
}

LoadPlace ResponseData::place_of(double stress_ratio) const noexcept {
    if (!(stress_ratio >= 0.0)) return {ResponseStatus::bad_load, {0, 0.0}, stress_ratio, false};
    const double at = std::log(stress_ratio);
    if (stress_ratio > most) return {ResponseStatus::above, {0, 0.0}, stress_ratio, false};
    if (at <= columns.at.front()) return {ResponseStatus::inside, {0, 0.0}, stress_ratio, true};
    return {ResponseStatus::inside, interval_of(columns.at, at), stress_ratio, false};
}

Response ResponseData::respond(Index column, double stress_ratio) const noexcept {
    const LoadPlace place = place_of(stress_ratio);
    if (place.status != ResponseStatus::inside) return {nan, nan, place.status};
    const Reading found = columns.read(column, place.where);
    return {found.value, place.before_all ? 0.0 : found.slope / stress_ratio, place.status};
}

// In a bin with an exact size the rest lies evenly, as `curve_on_grid` has it: a single exact size is that of grains whose
// neighbours in the next bin lie above it too.
Response ResponseData::percentile(double share, const LoadPlace& place) const noexcept {
    const auto finer = [&](Index i) {
        const Reading found = columns.read(i, place.where);
        return Dual{found.value, found.slope};
    };
    const auto respond_with = [&](double size, double slope) {
        return Response{size, place.before_all ? 0.0 : slope / place.stress_ratio, ResponseStatus::inside};
    };
    Index below = -1;  // the last bin in which the share is not reached
    Index bin = grid.bins() - 1;
    while (bin - below > 1) {
        const Index middle = below + (bin - below) / 2;
        (finer(middle).value >= share - share_rounding ? bin : below) = middle;
    }
    if (bin == 0) return {nan, nan, ResponseStatus::in_fines};

    const Dual before = finer(bin - 1);
    const Dual whole = finer(bin);
    const auto mass_of = [&](std::size_t q) {
        const Reading found = columns.read(exact_column(q), place.where);
        return Dual{found.value, found.slope};
    };
    Dual spread = whole - before;
    Dual next = bin + 1 < grid.bins() ? finer(bin + 1) - whole : Dual{0.0, 0.0};
    int in_bin = 0;
    for (std::size_t q = 0; q < exact.size(); ++q) {
        if (exact_bin[q] == bin && mass_of(q).value > 0.0) {
            spread = spread - mass_of(q);
            ++in_bin;
        }
        if (exact_bin[q] == bin + 1) next = next - mass_of(q);
    }
    const double low = grid.edge(bin);
    const double edge = grid.edge(bin + 1);
    const double top = std::log(largest);
    const double rounding = 1e-9 * grid.spacing();
    const double high = top > low + rounding && top <= edge + rounding ? std::min(top, edge) : edge;

    double from = low;
    Dual finer_from = before;
    Dual at_exact{0.0, 0.0};
    for (std::size_t q = 0; q < exact.size(); ++q) {
        const Dual mass = mass_of(q);
        if (exact_bin[q] != bin || !(mass.value > 0.0)) continue;
        const double psi = exact[q].psi;
        Dual even = std::min((psi - low) / (high - low), 1.0) * spread;
        if (in_bin == 1) {
            const double upper_part = std::clamp((edge - psi) / grid.spacing(), 0.0, 1.0);
            even = larger(even, spread - smaller(upper_part * next, spread));
        }
        const Dual reached = before + at_exact + even;
        if (share < reached.value - share_rounding) {
            const Dual log_size = crossing(share, from, finer_from, psi, reached);
            const double size = std::exp(log_size.value);
            return respond_with(size, size * log_size.slope);
        }
        if (share <= reached.value + mass.value + share_rounding) return respond_with(exact[q].size, 0.0);
        at_exact = at_exact + mass;
        from = psi;
        finer_from = reached + mass;
    }
    const Dual log_size = crossing(share, from, finer_from, high, whole);
    const double size = log_size.value >= high && high == top ? largest : std::exp(log_size.value);
    return respond_with(size, size * log_size.slope);
}

std::size_t ResponseData::memory() const {
    const std::size_t numbers = columns.at.size() * (1 + 2 * columns.values.size());
    return sizeof(ResponseData) + numbers * sizeof(double) + exact.size() * sizeof(PointMass);
}

}  // namespace comminute::detail
