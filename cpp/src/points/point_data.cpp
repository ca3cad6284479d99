// SPDX-License-Identifier: BSD-3-Clause
// Steps of material points: which points move, their blocks, their tasks (docs/guides/material_points.md).
#include "points/point_data.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <string>
#include <tuple>
#include <utility>

#include "base/check.hpp"
#include "base/workers.hpp"
#include "fabric/neighbourhoods.hpp"
#include "zones/shell_zone.hpp"

namespace comminute::detail {
namespace {

void require_list(Index found, Index count, const char* list) {
    if (found == count) return;  // words cost memory
    require_entries(found, count, entry(list), "there are " + std::to_string(count) + " points");
}

Fault fault_of(const char* list, Index i, double value, const char* rule) {
    return {
        .parameter = list, .value = text(value), .number = value, .rule = rule, .place = {entry(list, {i})}};
}

double rate_of(const PointLoads& loads, Index i) {
    return loads.loading_rate.size() == 0 ? 0.0 : loads.loading_rate[i];
}

bool remixes(const PointLoads& loads, Index i) {
    return loads.remix.size() != 0 && loads.remix[i] != 0;
}

void scale_to_one(double* numbers, Index count) {
    Line line(numbers, count);
    const double total = line.sum();
    if (total > 0.0) line /= total;
}

}  // namespace

PointData::PointData(const Material& of, const Fabric& given, Index count, const MaterialPointsOptions& o)
    : material(of),
      grid(given.grid()),
      options(o),
      mean(given.mean()),
      store(o.numbers, o.contents == PointContents::states ? grid.bins() * grid.bins() : 2 * grid.bins()) {
    material.validate_sharp();
    require(count >= 1, "count", static_cast<double>(count), "at least 1");
    const Fabric binned = given.binned();
    start_settled_at = binned.settled_at().value_or(0.0);
    start_largest = binned.largest();
    if (!keeps_states() && start_settled_at > 0.0) {
        throw ParameterError({.parameter = "start",
                              .finding = "has been loaded",
                              .rule = "points that keep gradings start from a mixed packing"});
    }
    const MatrixView<const double> p = binned.probability();
    start = LaneArray(grid.bins() * grid.bins() + lanes);
    std::copy_n(p.data(), grid.bins() * grid.bins(), start.begin());
    start_rows = Array<double>(binned.parts().rows);  // handed on, not summed anew, as solvers do
    begin = Array<PointState>(count, {shared, start_settled_at, 0.0, start_largest});
    end = begin;
    settled_at = Array<double>(count, start_settled_at);
    end_settled_at = settled_at;
    crushed = Array<double>(count);
    status = Array<PointStatus>(count, PointStatus::done);
    moving_.reserve(count);
}

PointData::PointData(const PointData& other)
    : material(other.material),
      grid(other.grid),
      options(other.options),
      mean(other.mean),
      start_settled_at(other.start_settled_at),
      start_largest(other.start_largest),
      start(other.start),
      start_rows(other.start_rows),
      store(other.store),
      begin(other.begin),
      end(other.end),
      settled_at(other.settled_at),
      end_settled_at(other.end_settled_at),
      crushed(other.crushed),
      status(other.status),
      faults(other.faults),
      waits(other.waits),
      moving_(other.moving_) {
    moving_.reserve(begin.size());
}

void PointData::require_point(Index i) const {
    require(i >= 0 && i < begin.size(), "i", static_cast<double>(i), "an index of a point");
}

void PointData::require_fit(const PointLoads& loads, Index threads) const {
    const Index count = begin.size();
    require(threads >= 1, "threads", static_cast<double>(threads), "at least 1");
    require_list(loads.stress_ratio.size(), count, "stress_ratio");
    if (loads.remix.size() != 0) require_list(loads.remix.size(), count, "remix");
    if (loads.loading_rate.size() != 0) require_list(loads.loading_rate.size(), count, "loading_rate");
}

void PointData::refuse(Index i, PointStatus why, Fault fault) {
    status[i] = why;
    faults.emplace(i, std::move(fault));
}

// Tells whether a point is to move; what is wrong with its load or rate is said in its status.
bool PointData::judge(const PointLoads& loads, Index i) {
    const double load = loads.stress_ratio[i];
    const double rate = rate_of(loads, i);
    status[i] = PointStatus::done;
    if (!(load >= 0.0)) {
        refuse(i, PointStatus::bad_load,
               fault_of("stress_ratio", i, load, "it must be a number of at least 0 (0 is no load)"));
        return false;
    }
    if (!(rate >= 0.0 && rate <= 1.0)) {
        refuse(i, PointStatus::bad_rate, fault_of("loading_rate", i, rate, "it must be between 0 and 1"));
        return false;
    }
    if (remixes(loads, i)) return true;
    if (!(load > begin[i].settled_at)) return false;
    if (keeps_states() || begin[i].settled_at == 0.0 || rate == begin[i].loading_rate) return true;
    refuse(i, PointStatus::rate_change,
           fault_of("loading_rate", i, rate,
                    "a point that keeps gradings has one loading rate from one mixing to the next"));
    return false;
}

// Tells whether a load crushes nothing even among grains of the coarsest bin that has any.
bool PointData::is_quiet(const PointState& state, double stress_ratio) const {
    const double top =
        state.largest > 0.0 ? grid.edge(grid.bin_of(std::log(state.largest)) + 1) : grid.edge(grid.bins());
    return stress_ratio == 0.0 || zone_onset(material, std::log(stress_ratio)) > top;
}

// Points with the same rate and loads come side by side, since they share solvers and zones.
void PointData::choose(const PointLoads& loads, bool in_place) {
    faults.clear();
    moving_.clear();
    for (Index i = 0; i < begin.size(); ++i) {
        end[i] = begin[i];
        crushed[i] = 0.0;
        if (!judge(loads, i)) continue;
        if (!remixes(loads, i) && is_quiet(begin[i], loads.stress_ratio[i])) {
            end[i].settled_at = loads.stress_ratio[i];
            continue;
        }
        moving_.push_back(i);
        if (!in_place || begin[i].block == shared) end[i].block = store.take();
        if (remixes(loads, i)) {
            end[i].settled_at = end[i].crushed = 0.0;
            end[i].mixed = true;
        }
        end[i].loading_rate = rate_of(loads, i);
    }
    std::sort(moving_.begin(), moving_.end(), [&](Index a, Index b) {
        return std::tuple(end[a].loading_rate, loads.stress_ratio[a], end[a].settled_at, a) <
               std::tuple(end[b].loading_rate, loads.stress_ratio[b], end[b].settled_at, b);
    });
}

bool PointData::step(const PointLoads& loads, Index threads, bool in_place) {
    require_fit(loads, threads);
    discard();
    choose(loads, in_place);
    const Index blocks = (moving_.size() + PointWorker::most - 1) / PointWorker::most;
    const Index used = std::clamp<Index>(blocks, 1, threads);
    while (static_cast<Index>(workers_.size()) < used) {
        workers_.push_back(std::make_unique<PointWorker>(grid, material, options.scheme));
    }
    const auto sweep_block = [&](Index block, Index worker) {
        const Index from = block * PointWorker::most;
        sweep(loads, from, std::min(from + PointWorker::most, moving_.size()), *at(workers_, worker));
    };
    if (used == 1) {
        for (Index block = 0; block < blocks; ++block) sweep_block(block, 0);
    } else {
        std::atomic<Index> next{0};
        for_each_index(static_cast<std::size_t>(used), static_cast<std::size_t>(used),
                       [&](std::size_t worker, const std::function<bool()>&) {
                           for (Index block = next++; block < blocks; block = next++) {
                               sweep_block(block, static_cast<Index>(worker));
                           }
                       },
                       {});
    }
    for (Index i = 0; i < end.size(); ++i) end_settled_at[i] = end[i].settled_at;
    waits = true;
    return faults.empty();
}

// Takes points through their step, those at one rate together.
void PointData::sweep(const PointLoads& loads, Index from, Index to, PointWorker& worker) {
    while (from < to) {
        const double rate = end[moving_[from]].loading_rate;
        Index stop = from;
        worker.clear();
        for (; stop < to && end[moving_[stop]].loading_rate == rate; ++stop) {
            begin_step(loads, moving_[stop], stop - from, worker);
        }
        worker.solve(rate);
        for (Index k = from; k < stop; ++k) end_step(moving_[k], k - from, worker);
        from = stop;
    }
}

// Begin state of a point that keeps states, mixed anew into `out` where that is asked for.
MatrixView<const double> PointData::begin_state(Index i, bool remix, MatrixView<double> out,
                                                PointWorker& worker) const {
    const PointState& state = begin[i];
    if (remix) {
        std::vector<double>& grading = worker.grading(0);
        read_grading(state, grading);
        mix_bins(grid, grading, mean, worker.neighbours(), out);
        return out;
    }
    if (state.block == shared) return start_state();
    if (const double* const numbers = store.doubles(state.block)) return {numbers, grid.bins(), grid.bins()};
    read(state, out.data());
    return out;
}

// Fabric from which a point that keeps gradings is solved: of its last mixing, or the start. Its grading becomes the one
// before the solve.
MatrixView<const double> PointData::begin_grading(Index i, bool remix, Index place,
                                                  PointWorker& worker) const {
    const PointState& state = begin[i];
    const Index bins = grid.bins();
    double* const both = worker.both_gradings(place);
    read(state, both);
    if (remix) std::copy_n(both + bins, bins, both);
    const bool mixed = remix || state.mixed;
    if (!mixed) std::copy(start_rows.begin(), start_rows.end(), both);
    std::copy_n(both, bins, worker.grading(place).begin());
    if (!mixed) return start_state();
    mix_bins(grid, {both, bins}, mean, worker.neighbours(), worker.state(place));
    return worker.state(place);
}

// Mixes the point where it is asked for, and adds its task where its load is then larger than the one it is at rest under.
void PointData::begin_step(const PointLoads& loads, Index i, Index place, PointWorker& worker) {
    const bool remix = remixes(loads, i);
    double* const own = keeps_states() ? store.doubles(end[i].block) : nullptr;
    const MatrixView<double> out =
        own != nullptr ? MatrixView<double>(own, grid.bins(), grid.bins()) : worker.state(place);
    const MatrixView<const double> from =
        keeps_states() ? begin_state(i, remix, out, worker) : begin_grading(i, remix, place, worker);
    const double load = loads.stress_ratio[i];
    if (!(load > end[i].settled_at)) return;
    // A grading is solved for from the mixing, at each load anew.
    const double settled = keeps_states() ? end[i].settled_at : 0.0;
    worker.add(place, {settled, load, end[i].largest}, from, keeps_states() ? &out : nullptr);
    end[i].settled_at = load;
}

void PointData::end_step(Index i, Index place, PointWorker& worker) {
    crushed[i] = worker.crushed(place);
    if (!keeps_states()) {
        const double before = std::exchange(end[i].crushed, crushed[i]);
        crushed[i] = std::max(crushed[i] - before, 0.0);
        double* const both = worker.both_gradings(place);
        std::copy_n(worker.grading(place).begin(), grid.bins(), both + grid.bins());
        store.write(both, end[i].block);
    } else if (store.doubles(end[i].block) == nullptr) {
        store.write(worker.state(place).data(), end[i].block);
    }
}

void PointData::commit() {
    if (!std::exchange(waits, false)) return;
    for (Index i = 0; i < begin.size(); ++i) {
        if (begin[i].block != shared && begin[i].block != end[i].block) store.give_back(begin[i].block);
        begin[i] = end[i];
    }
    settled_at = end_settled_at;
}

void PointData::discard() {
    if (!std::exchange(waits, false)) return;
    for (Index i = 0; i < begin.size(); ++i) {
        if (end[i].block != begin[i].block) store.give_back(end[i].block);
        end[i] = begin[i];
    }
    end_settled_at = settled_at;
}

void PointData::read(const PointState& state, double* to) const {
    if (state.block == shared) {
        const Index copies = keeps_states() ? 1 : 2;
        const Index count = store.size() / copies;
        const double* const from = keeps_states() ? start.data() : start_rows.data();
        for (Index copy = 0; copy < copies; ++copy) std::copy_n(from, count, to + copy * count);
        return;
    }
    store.read(state.block, to);
    if (options.numbers == PointNumbers::float64) return;
    const Index whole = keeps_states() ? store.size() : grid.bins();
    for (Index at = 0; at < store.size(); at += whole) scale_to_one(to + at, whole);
}

void PointData::read_grading(const PointState& state, VectorView<double> grainsize) const {
    const Index bins = grid.bins();
    if (state.block == shared) {
        std::copy(start_rows.begin(), start_rows.end(), grainsize.begin());
        return;
    }
    const auto number = [&](Index k) {
        const double* const wide = store.doubles(state.block);
        return wide != nullptr ? wide[k] : static_cast<double>(store.singles(state.block)[k]);
    };
    for (Index i = 0; i < bins; ++i) {
        double sum = keeps_states() ? 0.0 : number(bins + i);
        for (Index j = 0; keeps_states() && j < bins; ++j) sum += number(i * bins + j);
        grainsize[i] = sum;
    }
    if (options.numbers == PointNumbers::float32) scale_to_one(grainsize.data(), bins);
}

void PointData::replace(Index i, const double* numbers, const PointState& known) {
    discard();
    const Index block = begin[i].block == shared ? store.take() : begin[i].block;
    store.write(numbers, block);
    begin[i] = known;
    begin[i].block = block;
    end[i] = begin[i];
    settled_at[i] = end_settled_at[i] = known.settled_at;
}

void PointData::share_start(Index i, const PointState& known) {
    discard();
    if (begin[i].block != shared) store.give_back(begin[i].block);
    begin[i] = known;
    begin[i].block = shared;
    end[i] = begin[i];
    settled_at[i] = end_settled_at[i] = known.settled_at;
}

Fabric PointData::fabric(Index i) const {
    const PointState& state = begin[i];
    const auto settled = state.settled_at > 0.0 ? std::optional(state.settled_at) : std::nullopt;
    std::vector<double> numbers(static_cast<std::size_t>(store.size()));
    read(state, numbers.data());
    if (keeps_states()) return {grid, std::move(numbers), {}, settled, mean, {}, state.largest};
    std::vector<double> probability(start.begin(), start.begin() + grid.bins() * grid.bins());
    if (state.mixed) {
        Array<double> neighbours(grid.bins());
        mix_bins(grid, {numbers.data(), grid.bins()}, mean, {neighbours.data(), grid.bins()},
                 {probability.data(), grid.bins(), grid.bins()});
    }
    const Fabric mixed(grid, std::move(probability), {}, std::nullopt, mean, {}, state.largest);
    return settled ? QuasiStatic(grid, material, {options.scheme, state.loading_rate}).solve(mixed, *settled)
                   : mixed;
}

}  // namespace comminute::detail
