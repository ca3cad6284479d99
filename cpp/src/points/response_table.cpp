// SPDX-License-Identifier: BSD-3-Clause
// Tables of the settled grading against the load (docs/theory/response_tables.md).
#include "comminute/response_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/arrays.hpp"
#include "base/check.hpp"
#include "points/response_data.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr double first_spacing = 0.25;             // of ln(stress ratio), of the loads that are tried first
constexpr std::array<double, 2> probes{0.3, 0.7};  // places in an interval where the interpolant is tried
constexpr double safe = 0.5;  // share of the tolerance that it may be off there, since it is more elsewhere
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A row of the table: what the model says of one load.
using Row = std::vector<double>;

/// Follows the model over the load until its rows between nodes are those of the interpolant.
class Follower {
  public:
    Follower(QuasiStatic solver, const Fabric& start, const ResponseOptions& options)
        : solver_(std::move(solver)), start_(start), options_(options) {}

    /// ln(stress ratio) below which no grain crushes, whatever its neighbours: the largest among equals, and a bin to spare
    /// for a scheme that tests zones at the centres of bins.
    double before_the_first_crush() const {
        const Material& material = solver_.material();
        const double top = std::log(start_.largest() / material.reference_size) + solver_.grid().spacing();
        return -3.0 / material.weibull_modulus * top;
    }

    ResponseColumns follow(double log_load) {
        const double first = std::min(before_the_first_crush(), log_load - first_spacing);
        const double among_equals =
            first + 3.0 / solver_.material().weibull_modulus * solver_.grid().spacing();
        at_.push_back(first);
        if (among_equals < log_load) {
            at_.push_back(among_equals -
                          0.5 * jump_width);  // where equal grains crush at once the response jumps
            at_.push_back(among_equals + 0.5 * jump_width);
        }
        for (double at = at_.back() + first_spacing; at < log_load - 0.5 * first_spacing; at += first_spacing)
            at_.push_back(at);
        at_.push_back(log_load);
        rows_ = rows_at(at_);
        known_.assign(at_.size(), false);
        while (refine()) {
        }
        return columns();
    }

  private:
    std::vector<Row> rows_at(const std::vector<double>& log_loads) {
        std::vector<double> loads;
        loads.reserve(log_loads.size());
        for (const double log_load : log_loads) loads.push_back(std::exp(log_load));
        std::vector<Row> rows;
        for (const Marginal& after : solver_.marginals(start_, loads)) rows.push_back(row_of(after));
        return rows;
    }

    Row row_of(const Marginal& after) const {
        Row row;
        double finer = 0.0;
        for (const double mass : after.grainsize) row.push_back(finer += mass);
        for (const PointMass& exact : start_.points()) {
            const auto same = [&](const PointMass& point) { return point.size == exact.size; };
            const auto found = std::find_if(after.points.begin(), after.points.end(), same);
            row.push_back(found == after.points.end() ? 0.0 : found->mass);
        }
        row.push_back(after.report.crushed);
        return row;
    }

    ResponseColumns columns() const {
        ResponseColumns table;
        table.at = at_;
        for (std::size_t j = 0; j < rows_.front().size(); ++j) {
            std::vector<double> values;
            for (const Row& row : rows_) values.push_back(row[j]);
            table.add(std::move(values));
        }
        return table;
    }

    bool untried(std::size_t k) const {
        return k + 1 < at_.size() && !known_[k] && at_[k + 1] - at_[k] > jump_width;
    }

    // Largest difference of the mass finer than an edge between the interpolant and what the model says of two places.
    double error_at(const ResponseColumns& table, std::size_t k, const Row* found) const {
        double error = 0.0;
        for (std::size_t p = 0; p < probes.size(); ++p) {
            const Interval where{static_cast<Index>(k), probes[p]};
            for (Index j = 0; j < solver_.grid().bins(); ++j) {
                const double model = found[p][static_cast<std::size_t>(j)];
                error = std::max(error, std::abs(table.read(j, where).value - model));
            }
        }
        return error;
    }

    // Tries two places in every interval that nobody has tried yet, and keeps both where the interpolant is off at either.
    bool refine() {
        std::vector<double> tried;
        for (std::size_t k = 0; k < at_.size(); ++k) {
            if (!untried(k)) continue;
            for (const double probe : probes) tried.push_back(at_[k] + probe * (at_[k + 1] - at_[k]));
        }
        std::vector<Row> found = rows_at(tried);
        const ResponseColumns table = columns();
        std::vector<double> at;
        std::vector<Row> rows;
        std::vector<bool> known;
        bool more = false;
        std::size_t next = 0;
        for (std::size_t k = 0; k < at_.size(); ++k) {
            at.push_back(at_[k]);
            rows.push_back(std::move(rows_[k]));
            known.push_back(known_[k]);
            if (!untried(k)) continue;
            known.back() = error_at(table, k, &found[next]) <= safe * options_.tolerance;
            if (!known.back()) {
                more = true;
                for (std::size_t p = 0; p < probes.size(); ++p) {
                    at.push_back(tried[next + p]);
                    rows.push_back(std::move(found[next + p]));
                    known.push_back(false);
                }
            }
            next += probes.size();
        }
        at_ = std::move(at);
        rows_ = std::move(rows);
        known_ = std::move(known);
        if (static_cast<Index>(at_.size()) > options_.most_loads) {
            throw ParameterError(
                {.parameter = "tolerance",
                 .value = text(options_.tolerance),
                 .number = options_.tolerance,
                 .finding = "takes more than " + std::to_string(options_.most_loads) + " loads",
                 .rule = "it must be greater, or most_loads"});
        }
        return more;
    }

    QuasiStatic solver_;
    const Fabric& start_;
    ResponseOptions options_;
    std::vector<double> at_;
    std::vector<Row> rows_;
    std::vector<bool> known_;  // whether the interval after a node needs no other
};

[[noreturn]] void refuse_scalar(const std::string& name, double value, Index load) {
    throw ParameterError({.parameter = name,
                          .value = text(value),
                          .number = value,
                          .rule = "it must be finite",
                          .place = {entry("at_loads", {load})}});
}

}  // namespace

ResponseTable::ResponseTable(QuasiStatic solver, const Fabric& start, double max_stress_ratio,
                             const ResponseOptions& options) {
    require(max_stress_ratio > 0.0 && std::isfinite(max_stress_ratio), "max_stress_ratio", max_stress_ratio,
            "greater than 0 and finite");
    require(options.tolerance > 0.0, "tolerance", options.tolerance, "greater than 0");
    require(options.most_loads >= 8, "most_loads", static_cast<double>(options.most_loads), "at least 8");
    if (const double settled = start.settled_at().value_or(0.0); settled > 0.0) {
        throw ParameterError({.parameter = "start",
                              .value = text(settled),
                              .number = settled,
                              .finding = "is at rest under a stress ratio of " + text(settled),
                              .rule = "a table starts from a packing that was never loaded"});
    }
    const LogGrid grid = solver.grid();
    auto data = std::make_shared<Data>(grid, options, start.largest(), max_stress_ratio, start.points());
    data->columns = Follower(std::move(solver), start, options).follow(std::log(max_stress_ratio));
    data_ = std::move(data);
}

ResponseTable::ResponseTable(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

ResponseTable ResponseTable::with_scalar(const std::string& name, const std::vector<double>& at_loads) const {
    require_entries(static_cast<Index>(at_loads.size()), static_cast<Index>(data_->columns.at.size()),
                    entry("at_loads"),
                    "the table has " + std::to_string(data_->columns.at.size()) + " loads");
    if (index_of(name) >= 0 || name.empty()) {
        throw ParameterError(
            {.parameter = "name",
             .value = name,
             .rule = name.empty() ? "it must not be empty" : "the table has such a scalar already"});
    }
    for (std::size_t t = 0; t < at_loads.size(); ++t)
        if (!std::isfinite(at_loads[t])) refuse_scalar(name, at_loads[t], static_cast<Index>(t));
    auto data = std::make_shared<Data>(*data_);
    data->names.push_back(name);
    data->columns.add(at_loads);
    return ResponseTable(std::move(data));
}

const LogGrid& ResponseTable::grid() const {
    return data_->grid;
}
const ResponseOptions& ResponseTable::options() const {
    return data_->options;
}

std::vector<double> ResponseTable::stress_ratios() const {
    std::vector<double> loads;
    for (const double at : data_->columns.at) loads.push_back(std::exp(at));
    loads.back() = data_->most;  // to the bit, so that the table knows it
    return loads;
}

std::vector<std::string> ResponseTable::scalars() const {
    return data_->names;
}

Index ResponseTable::index_of(const std::string& name) const {
    const auto found = std::find(data_->names.begin(), data_->names.end(), name);
    return found == data_->names.end() ? -1 : found - data_->names.begin();
}

double ResponseTable::largest() const {
    return data_->largest;
}

Response ResponseTable::crushes(double stress_ratio) const noexcept {
    return data_->respond(data_->crushes_column(), stress_ratio);
}

Response ResponseTable::finer(Index bin, double stress_ratio) const noexcept {
    if (bin < 0 || bin >= data_->grid.bins()) return {nan, nan, ResponseStatus::no_scalar};
    return data_->respond(bin, stress_ratio);
}

Response ResponseTable::scalar(Index index, double stress_ratio) const noexcept {
    if (index < 0 || index >= static_cast<Index>(data_->names.size()))
        return {nan, nan, ResponseStatus::no_scalar};
    return data_->respond(data_->crushes_column() + 1 + index, stress_ratio);
}

Response ResponseTable::percentile(double percent, double stress_ratio) const noexcept {
    const LoadPlace place = data_->place_of(stress_ratio);
    if (place.status != ResponseStatus::inside) return {nan, nan, place.status};
    if (!(percent >= 0.0 && percent <= 100.0)) return {nan, nan, ResponseStatus::no_scalar};
    return data_->percentile(percent / 100.0, place);
}

ResponseStatus ResponseTable::grading(double stress_ratio, VectorView<double> cdf) const {
    require_bins(cdf.size(), data_->grid.bins(), entry("cdf"));
    const LoadPlace place = data_->place_of(stress_ratio);
    if (place.status != ResponseStatus::inside) return place.status;
    for (Index i = 0; i < cdf.size(); ++i) cdf[i] = data_->columns.read(i, place.where).value;
    return place.status;
}

std::vector<PointMass> ResponseTable::points(double stress_ratio) const {
    std::vector<PointMass> points;
    const LoadPlace place = data_->place_of(stress_ratio);
    if (place.status != ResponseStatus::inside) return points;
    for (std::size_t q = 0; q < data_->exact.size(); ++q) {
        PointMass point = data_->exact[q];
        point.mass = data_->columns.read(data_->exact_column(q), place.where).value;
        if (point.mass > 0.0) points.push_back(point);
    }
    return points;
}

std::size_t ResponseTable::memory() const {
    return data_->memory();
}

bool operator==(const ResponseTable& a, const ResponseTable& b) {
    return a.data_ == b.data_ || *a.data_ == *b.data_;
}

}  // namespace comminute
