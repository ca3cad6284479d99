// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace comminute::detail {

/// The 12-point Gauss-Legendre rule on [-1, 1], positive half of the nodes; exact to degree 23.
struct GaussRule12 {
    static constexpr std::array<double, 6> node{0.12523340851146891547, 0.36783149899818019375,
                                                0.58731795428661744730, 0.76990267419430468704,
                                                0.90411725637047485668, 0.98156063424671925069};
    static constexpr std::array<double, 6> weight{0.24914704581340278500, 0.23349253653835480876,
                                                  0.20316742672306592175, 0.16007832854334622633,
                                                  0.10693932599531843096, 0.04717533638651182719};
};

/// The 3-point rule on [0, 1] as (node, weight); exact to degree 5.
inline constexpr std::array<std::pair<double, double>, 3> gauss_3_unit{
    {{0.11270166537925831148, 5.0 / 18.0}, {0.5, 8.0 / 18.0}, {0.88729833462074168852, 5.0 / 18.0}}};

/// Integral of `f` over [from, to] by the 12-point rule on `panels` equal panels; `zero` of the type that f returns.
template <class F, class Value = double>
Value integrate(const F& f, double from, double to, int panels, const Value& zero = 0.0) {
    const double half = 0.5 * (to - from) / panels;
    Value sum = zero;
    for (int p = 0; p < panels; ++p) {
        const double centre = from + half * (2 * p + 1);
        for (std::size_t q = 0; q < GaussRule12::node.size(); ++q) {
            const double offset = half * GaussRule12::node[q];
            sum += GaussRule12::weight[q] * (f(centre - offset) + f(centre + offset));
        }
    }
    return half * sum;
}

}  // namespace comminute::detail
