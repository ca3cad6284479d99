// SPDX-License-Identifier: BSD-3-Clause
// Tables side by side along a second variable (docs/theory/response_tables.md, section 4).
#include "comminute/response_family.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/arrays.hpp"
#include "base/check.hpp"
#include "points/bytes.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr ByteKind kind{{'c', 'm', 'f', 'a', 'm', 'i', 'l', 'y'}, 1, "response family"};
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

[[noreturn]] void refuse_table(Index k, const char* what) {
    throw ParameterError(
        {.parameter = "tables",
         .finding = std::string("has another ") + what + " than the first",
         .rule =
             "the tables of a family have one grid, one range of loads, one largest grain and the same "
             "exact sizes and scalars; sizes that are all scaled alike are one table, whose loads scale as "
             "the size to the power -3/w",
         .place = {entry("tables", {k})}});
}

std::vector<double> exact_sizes_of(const ResponseTable& table) {
    std::vector<double> sizes;
    for (const PointMass& point : table.points(0.0)) sizes.push_back(point.size);
    return sizes;
}

void require_like(const ResponseTable& table, const ResponseTable& first, Index k) {
    if (table.grid() != first.grid()) refuse_table(k, "grid");
    if (table.stress_ratios().back() != first.stress_ratios().back()) refuse_table(k, "largest load");
    if (table.largest() != first.largest()) refuse_table(k, "largest grain");
    if (exact_sizes_of(table) != exact_sizes_of(first)) refuse_table(k, "set of exact sizes");
    if (table.scalars() != first.scalars()) refuse_table(k, "set of scalars");
}

// Largest distance of a grading from the mean of two others, over the loads of all three.
double error_between(const ResponseTable& below, const ResponseTable& above, const ResponseTable& between) {
    const auto bins = static_cast<std::size_t>(between.grid().bins());
    std::vector<double> one(bins), other(bins), middle(bins);
    double error = 0.0;
    for (const ResponseTable* table : {&below, &above, &between}) {
        for (const double load : table->stress_ratios()) {
            below.grading(load, one);
            above.grading(load, other);
            between.grading(load, middle);
            for (std::size_t i = 0; i < bins; ++i) {
                error = std::max(error, std::abs(0.5 * (one[i] + other[i]) - middle[i]));
            }
        }
    }
    return error;
}

}  // namespace

struct ResponseFamily::Data {
    std::vector<double> values;
    std::vector<ResponseTable> tables;

    /// A value among the nodes: the interval and the share of it that lies below.
    struct Between {
        std::size_t k;
        double share;
        double width;
        bool inside;
    };

    Between between(double value) const noexcept {
        if (!(value >= values.front() && value <= values.back())) return {0, 0.0, 1.0, false};
        const auto above = std::upper_bound(values.begin() + 1, values.end() - 1, value);
        const auto k = static_cast<std::size_t>(above - values.begin()) - 1;
        const double width = values[k + 1] - values[k];
        return {k, (value - values[k]) / width, width, true};
    }

    /// @param read  look-up in one table
    template <class Read>
    FamilyResponse linear(double value, const Read& read) const noexcept {
        const Between at = between(value);
        if (!at.inside) return {nan, nan, nan, ResponseStatus::outside};
        const Response below = read(tables[at.k]);
        const Response above = read(tables[at.k + 1]);
        if (below.status != ResponseStatus::inside) return {nan, nan, nan, below.status};
        if (above.status != ResponseStatus::inside) return {nan, nan, nan, above.status};
        const double rise = above.value - below.value;
        return {below.value + at.share * rise,
                below.derivative + at.share * (above.derivative - below.derivative), rise / at.width,
                ResponseStatus::inside};
    }
};

ResponseFamily::ResponseFamily(std::vector<double> values, std::vector<ResponseTable> tables) {
    require(values.size() >= 2, "number of values", static_cast<double>(values.size()), "at least 2");
    require_entries(static_cast<Index>(tables.size()), static_cast<Index>(values.size()), entry("tables"),
                    "there are " + std::to_string(values.size()) + " values");
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (!std::isfinite(values[k])) refuse_not_finite(values[k], entry("values", k), finite);
        if (k == 0) continue;
        require(values[k] > values[k - 1], ("values[" + std::to_string(k) + "]").c_str(), values[k],
                "greater than the one before");
        require_like(tables[k], tables.front(), static_cast<Index>(k));
    }
    data_ = std::make_shared<Data>(Data{std::move(values), std::move(tables)});
}

ResponseFamily ResponseFamily::refined(std::vector<double> values,
                                       const std::function<ResponseTable(double)>& table_at,
                                       const FamilyOptions& options) {
    require(options.tolerance > 0.0, "tolerance", options.tolerance, "greater than 0");
    require(options.most_nodes >= 2, "most_nodes", static_cast<double>(options.most_nodes), "at least 2");
    std::vector<ResponseTable> tables;
    tables.reserve(values.size());
    for (const double value : values) tables.push_back(table_at(value));
    const ResponseFamily coarse(values, tables);  // which checks them
    for (std::size_t k = 0; k + 1 < values.size();) {
        const double value = 0.5 * (values[k] + values[k + 1]);
        ResponseTable middle = table_at(value);
        if (error_between(tables[k], tables[k + 1], middle) <= options.tolerance) {
            ++k;
            continue;
        }
        const auto at = static_cast<std::ptrdiff_t>(k) + 1;
        values.insert(values.begin() + at, value);
        tables.insert(tables.begin() + at, std::move(middle));
        if (static_cast<Index>(values.size()) > options.most_nodes) {
            throw ParameterError(
                {.parameter = "tolerance",
                 .value = text(options.tolerance),
                 .number = options.tolerance,
                 .finding = "takes more than " + std::to_string(options.most_nodes) + " nodes",
                 .rule = "it must be greater, or most_nodes, or the range of values smaller"});
        }
    }
    return {std::move(values), std::move(tables)};
}

const LogGrid& ResponseFamily::grid() const {
    return data_->tables.front().grid();
}
const std::vector<double>& ResponseFamily::values() const {
    return data_->values;
}
const std::vector<ResponseTable>& ResponseFamily::tables() const {
    return data_->tables;
}

FamilyResponse ResponseFamily::crushes(double stress_ratio, double value) const noexcept {
    return data_->linear(value, [&](const ResponseTable& table) { return table.crushes(stress_ratio); });
}
FamilyResponse ResponseFamily::finer(Index bin, double stress_ratio, double value) const noexcept {
    return data_->linear(value, [&](const ResponseTable& table) { return table.finer(bin, stress_ratio); });
}
FamilyResponse ResponseFamily::scalar(Index index, double stress_ratio, double value) const noexcept {
    return data_->linear(value,
                         [&](const ResponseTable& table) { return table.scalar(index, stress_ratio); });
}

FamilyResponse ResponseFamily::percentile(double percent, double stress_ratio, double value) const noexcept {
    FamilyResponse log_size = data_->linear(value, [&](const ResponseTable& table) {
        Response size = table.percentile(percent, stress_ratio);
        size.derivative /= size.value;
        size.value = std::log(size.value);
        return size;
    });
    const double size = std::exp(log_size.value);
    return {size, size * log_size.by_load, size * log_size.by_variable, log_size.status};
}

ResponseStatus ResponseFamily::grading(double stress_ratio, double value, VectorView<double> cdf) const {
    require_bins(cdf.size(), grid().bins(), entry("cdf"));
    for (Index i = 0; i < cdf.size(); ++i) {
        const FamilyResponse found = finer(i, stress_ratio, value);
        if (found.status != ResponseStatus::inside) return found.status;
        cdf[i] = found.value;
    }
    return ResponseStatus::inside;
}

std::vector<PointMass> ResponseFamily::points(double stress_ratio, double value) const {
    const Data::Between at = data_->between(value);
    if (!at.inside) return {};
    const std::vector<PointMass> below = data_->tables[at.k].points(stress_ratio);
    const std::vector<PointMass> above = data_->tables[at.k + 1].points(stress_ratio);
    std::vector<PointMass> points;
    for (PointMass point : data_->tables.front().points(0.0)) {
        const auto mass_in = [&](const std::vector<PointMass>& found) {
            const auto same = [&](const PointMass& other) { return other.size == point.size; };
            const auto place = std::find_if(found.begin(), found.end(), same);
            return place == found.end() ? 0.0 : place->mass;
        };
        point.mass = (1.0 - at.share) * mass_in(below) + at.share * mass_in(above);
        if (point.mass > 0.0) points.push_back(point);
    }
    return points;
}

std::size_t ResponseFamily::memory() const {
    std::size_t bytes = data_->values.size() * sizeof(double);
    for (const ResponseTable& table : data_->tables) bytes += table.memory();
    return bytes;
}

std::vector<unsigned char> ResponseFamily::to_bytes() const {
    ByteWriter out(kind);
    out.number(data_->values.size());
    out.reals(data_->values);
    for (const ResponseTable& table : data_->tables) {
        const std::vector<unsigned char> bytes = table.to_bytes();
        out.text({bytes.begin(), bytes.end()});
    }
    return out.sealed();
}

ResponseFamily ResponseFamily::from_bytes(VectorView<const unsigned char> bytes) {
    ByteReader in(kind, bytes);
    std::vector<double> values = in.reals(in.size());
    std::vector<ResponseTable> tables;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const std::string words = in.text();
        const std::vector<unsigned char> table(words.begin(), words.end());
        tables.push_back(ResponseTable::from_bytes(table));
    }
    in.require_end();
    return {std::move(values), std::move(tables)};
}

bool operator==(const ResponseFamily& a, const ResponseFamily& b) {
    return a.values() == b.values() && a.tables() == b.tables();
}

}  // namespace comminute
