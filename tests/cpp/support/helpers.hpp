// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <comminute/comminute.hpp>

#define CHECK_REFUSED(call, text) CHECK_THROWS_WITH_AS(call, text, comminute::ParameterError)
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

// Helpers of several test files. Nothing here calls the part of the library that it helps to test.
namespace helpers {

using comminute::Index;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

inline std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Mass may be checked to the last bit or two only if the check itself does not round.
inline double sum_of(const std::vector<double>& values) {
    long double sum = 0.0L;
    for (const double v : values) sum += static_cast<long double>(v);
    return static_cast<double>(sum);
}

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    if (a.size() != b.size()) return infinity;
    double largest = 0.0;
    for (std::size_t q = 0; q < a.size(); ++q) {
        const double difference = std::abs(a[q] - b[q]);
        if (!(difference <= largest)) largest = difference;  // keeps a NaN
    }
    return largest;
}

inline double smallest_entry(const std::vector<double>& values) {
    return *std::min_element(values.begin(), values.end());
}

/// An (N, N) state that owns its numbers.
struct State {
    Index bins;
    std::vector<double> mass;

    explicit State(Index n) : bins(n), mass(at(n * n), 0.0) {}
    State(Index n, std::vector<double> numbers) : bins(n), mass(std::move(numbers)) {}

    double& operator()(Index i, Index j) { return mass[at(i * bins + j)]; }
    double operator()(Index i, Index j) const { return mass[at(i * bins + j)]; }
    comminute::MatrixView<double> view() { return {mass.data(), bins, bins}; }
    comminute::MatrixView<const double> view() const { return {mass.data(), bins, bins}; }
    double total() const { return sum_of(mass); }

    /// Mass by row (psi) or by column (psibar).
    std::vector<double> by_grain() const {
        std::vector<double> sums(at(bins), 0.0);
        for (Index i = 0; i < bins; ++i)
            for (Index j = 0; j < bins; ++j) sums[at(i)] += (*this)(i, j);
        return sums;
    }
    std::vector<double> by_neighbour() const {
        std::vector<double> sums(at(bins), 0.0);
        for (Index i = 0; i < bins; ++i)
            for (Index j = 0; j < bins; ++j) sums[at(j)] += (*this)(i, j);
        return sums;
    }
};

/// Random masses that add up to `total`; a share `empty` of the cells holds none.
inline State random_state(Index bins, std::mt19937_64& random, double total = 1.0, double empty = 0.0) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    State state(bins);
    for (double& mass : state.mass) mass = unit(random) < empty ? 0.0 : unit(random);
    const double scale = total / state.total();
    for (double& mass : state.mass) mass *= scale;
    return state;
}

/// Composite Simpson rule on 2 * pairs intervals.
template <class F>
double simpson(const F& f, double from, double to, int pairs) {
    const double h = (to - from) / (2.0 * pairs);
    long double sum = f(from) + f(to);
    for (int q = 1; q < 2 * pairs; ++q) sum += (q % 2 == 1 ? 4.0L : 2.0L) * f(from + q * h);
    return static_cast<double>(sum * h / 3.0L);
}

/// A number drawn evenly in its logarithm.
inline double log_uniform(std::mt19937_64& random, double from, double to) {
    return std::exp(std::uniform_real_distribution<double>(std::log(from), std::log(to))(random));
}

/// Eq. 2 afresh, as the logarithm of the critical stress ratio.
inline double log_critical(const comminute::Material& m, double psi, double psibar) {
    const double contrast = psi - psibar;
    return -3.0 / m.weibull_modulus * (psi - std::log(m.reference_size)) +
           contrast * contrast / (2.0 * m.fabric_width * m.fabric_width);
}

inline comminute::Material material(double n, double w = 3.0, double reference_size = 1.0) {
    comminute::Material m;
    m.fabric_width = n;
    m.weibull_modulus = w;
    m.reference_size = reference_size;
    return m;
}

inline comminute::Material random_material(std::mt19937_64& random) {
    return material(log_uniform(random, 0.01, 5.0), log_uniform(random, 0.8, 12.0),
                    log_uniform(random, 0.05, 20.0));
}

/// Any stepping engine behind one face, so that each law of the model is put to all of them.
struct Engine {
    std::string name;
    comminute::Kernel kernel;
    std::function<comminute::StepReport(comminute::MatrixView<const double>, double,
                                        comminute::MatrixView<double>)>
        step;
    std::function<comminute::StepReport(comminute::MatrixView<double>, double, Index,
                                        const std::function<bool()>&)>
        settle;
};

template <class E>
Engine wrap(const std::string& name, E engine) {
    const auto shared = std::make_shared<E>(std::move(engine));
    return {name, shared->kernel(),
            [shared](comminute::MatrixView<const double> p, double load, comminute::MatrixView<double> out) {
                return shared->step(p, load, out);
            },
            [shared](comminute::MatrixView<double> p, double load, Index steps,
                     const std::function<bool()>& go_on) {
                return comminute::settle(*shared, p, load, steps, go_on);
            }};
}

// The means by which this build can take a full step of a kernel.
inline std::vector<comminute::StepPath> step_paths(const comminute::Kernel& kernel) {
    std::vector<comminute::StepPath> paths{comminute::StepPath::direct};
#ifdef COMMINUTE_HAS_FFTW
    paths.push_back(comminute::StepPath::transforms);
#endif
    const auto sum = comminute::exponential_sum(kernel.material().fragments, kernel.grid().spacing(),
                                                kernel.fragments(), kernel.options().scheme);
    if (!sum.coefficient.empty() && sum.head == 0) paths.push_back(comminute::StepPath::sums);
    return paths;
}

inline std::vector<Engine> all_engines(const comminute::LogGrid& grid, const comminute::Material& material,
                                       comminute::Scheme scheme = comminute::Scheme::paper) {
    std::vector<Engine> engines;
    engines.push_back(wrap("slow update", comminute::SlowUpdate(grid, material, {scheme})));
    const auto add = [&](const std::string& name, comminute::KernelKind kind, double rate) {
        const comminute::KernelOptions options{kind, rate, scheme};
        for (const comminute::StepPath path : step_paths({grid, material, options})) {
            const std::string by = path == comminute::StepPath::sums     ? ", sums"
                                   : path == comminute::StepPath::direct ? ", direct"
                                                                         : "";
            engines.push_back(wrap(name + by, comminute::FullConvolution(grid, material, {options, path})));
        }
    };
    add("exact", comminute::KernelKind::exact, 0.0);
    add("slow", comminute::KernelKind::slow, 0.0);
    add("fast", comminute::KernelKind::fast, 0.0);
    add("blend", comminute::KernelKind::blend, 0.3);
    return engines;
}

// Eq. 38, cell by cell: the mass of each cell goes where that cell's own kernel sends it.
inline State dense_step(const comminute::Kernel& kernel, const State& p, double stress_ratio) {
    State sum(p.bins);
    State spread(p.bins);
    for (Index i = 0; i < p.bins; ++i) {
        for (Index j = 0; j < p.bins; ++j) {
            if (p(i, j) == 0.0) continue;
            kernel.cell(i, j, stress_ratio, spread.view());
            for (std::size_t c = 0; c < sum.mass.size(); ++c) sum.mass[c] += p(i, j) * spread.mass[c];
        }
    }
    return sum;
}

inline double mean_of(const std::vector<double>& pmf, const comminute::LogGrid& grid) {
    long double sum = 0.0L;
    for (std::size_t i = 0; i < pmf.size(); ++i) {
        sum += static_cast<long double>(pmf[i]) * grid.centre(static_cast<Index>(i));
    }
    return static_cast<double>(sum);
}

}  // namespace helpers
