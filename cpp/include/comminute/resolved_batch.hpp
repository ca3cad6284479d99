// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/resolved.hpp"
#include "comminute/view.hpp"

namespace comminute {

/// Gradings of many materials after the same number of loads, from one start on one grid: what a fit or a sweep asks for.
/// On one grid they change smoothly with the material, which nodes that follow its fabric width would spoil; take the
/// nodes of the smallest width.
///
/// @param pmf           (N) mass of each node, of which the packing is a random mixture
/// @param stress_ratio  (M, T) loads of each material, in any order: a lower one changes nothing
/// @param threads       materials that are worked on at a time; the same bits
/// @param go_on         asked between loads in the calling thread; if it answers false (or throws) the batch stops
/// @return              (M, T, N) mass by node; what was not reached when `go_on` said no is 0
/// @throws ShapeError for another number of materials or nodes; ParameterError as `Resolved`, naming the material
///
/// @code{.cpp}
/// std::vector<comminute::Material> sands(2);
/// sands[1].weibull_modulus = 6.0;
/// auto grid = comminute::ResolvedGrid::graded(0.05, -8.0, {0.0}, {});
/// auto pmf = comminute::node_pmf(comminute::monodisperse(1.0), grid);
/// const std::vector<double> loads{1.0, 8.0, 1.0, 8.0};
/// auto mass = comminute::resolved_gradings(grid, pmf, sands, {loads.data(), 2, 2});
/// CHECK(mass.size() == 2 * 2 * 46);
/// @endcode
COMMINUTE_API std::vector<double> resolved_gradings(const ResolvedGrid& grid, const std::vector<double>& pmf,
                                                    const std::vector<Material>& materials,
                                                    MatrixView<const double> stress_ratio,
                                                    const ResolvedOptions& options = {}, Index threads = 1,
                                                    const std::function<bool()>& go_on = {});

}  // namespace comminute
