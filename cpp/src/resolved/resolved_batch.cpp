// SPDX-License-Identifier: BSD-3-Clause
// Many materials from one start, each along its own clock (docs/theory/three_cells.md, section 5).
#include "comminute/resolved_batch.hpp"

#include <algorithm>
#include <string>

#include "base/check.hpp"
#include "base/workers.hpp"

namespace comminute {

using namespace detail;

std::vector<double> resolved_gradings(const ResolvedGrid& grid, const std::vector<double>& pmf,
                                      const std::vector<Material>& materials,
                                      MatrixView<const double> stress_ratio, const ResolvedOptions& options,
                                      Index threads, const std::function<bool()>& go_on) {
    const auto members = static_cast<Index>(materials.size());
    require_entries(stress_ratio.rows(), members, entry("stress_ratio"),
                    "there are " + std::to_string(members) + " materials");
    require(threads >= 1, "threads", static_cast<double>(threads), "at least 1");
    const Index nodes = grid.nodes();
    const Index loads = stress_ratio.cols();
    std::vector<double> gradings(static_cast<std::size_t>(members * loads * nodes), 0.0);
    const auto work = [&](std::size_t member, const std::function<bool()>& ask) {
        const auto m = static_cast<Index>(member);
        try {
            Resolved law(grid, materials[member], pmf, options);
            for (Index t = 0; t < loads && ask(); ++t) {
                law.load_to(stress_ratio(m, t));
                const std::vector<double> mass = law.pmf();
                std::copy(mass.begin(), mass.end(), gradings.begin() + (m * loads + t) * nodes);
            }
        } catch (const ParameterError& error) {
            throw ParameterError(within(entry("materials", {m}), error.fault()));
        }
    };
    for_each_index(materials.size(), static_cast<std::size_t>(threads), work, go_on);
    return gradings;
}

}  // namespace comminute
