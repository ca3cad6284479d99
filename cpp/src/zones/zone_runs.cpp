// SPDX-License-Identifier: BSD-3-Clause
// Runs of one row from the zones of the shells it crosses (docs/theory/one_sweep.md, section 13).
#include "zones/zone_runs.hpp"

#include <algorithm>

namespace comminute::detail {

ZoneRuns::ZoneRuns(const LogGrid& grid, const Material& material)
    : zones_(grid, material, 0.0), runs_(grid.bins()) {}

void ZoneRuns::set_load(double stress_ratio) {
    zones_.set_load(stress_ratio);
    widest_ = -1;
    for (Index m = 0; m < zones_.grid().bins(); ++m) widest_ = std::max(widest_, zones_.band(m));
}

void ZoneRuns::add(Index begin, Index end, Zone zone) {
    if (begin < end) runs_[count_++] = {begin, end, zone};
}

// Cells with a finer neighbour belong to the row's own shell, so that either zone is one interval of them. A cell with a
// coarser neighbour belongs to the shell of its column.
VectorView<const ZoneRun> ZoneRuns::of_row(Index i) {
    count_ = 0;
    const Index both = i - std::max(zones_.overlap(i), Index{0});
    add(i - std::max(zones_.band(i), Index{0}), both, Zone::grain);
    add(both, i, Zone::both);
    if (zones_.band(i) >= 0) add(i, i + 1, zones_.at(i, i));
    const Index end = std::min(i + widest_ + 1, zones_.grid().bins());
    for (Index j = i + 1; j < end;) {
        const Zone zone = zones_.at(i, j);
        const Index begin = j;
        while (++j < end && zones_.at(i, j) == zone) {
        }
        if (zone != Zone::rest) add(begin, j, zone);
    }
    return {runs_.data(), count_};
}

}  // namespace comminute::detail
