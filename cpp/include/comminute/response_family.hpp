// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/response_table.hpp"

namespace comminute {

/// A number under a load at a value of the second variable, and its derivatives by either.
struct FamilyResponse {
    double value;
    double by_load;      ///< derivative by the stress ratio
    double by_variable;  ///< derivative by the second variable; at a node that of the interval above it
    ResponseStatus status;
};

/// How finely a response family follows its second variable.
struct FamilyOptions {
    double tolerance = 1e-3;  ///< > 0, error of the mass finer than a size between the nodes
    Index most_nodes = 129;   ///< >= 2, above which a family that needs more is refused
};

/// Response tables over a second variable: a parameter of the initial grading, or the loading rate.
///
/// A table stands at each of some values of the variable, the nodes. All are on one grid and begin with one largest grain,
/// so that their first crush lies at one load. Between two nodes everything is linear in the variable: a grading there is
/// the mixture of its two neighbours, which is a grading whatever the tolerance, and sizes such as D50 are linear in their
/// logarithm.
///
/// Immutable, as the tables are: copies are cheap and threads share it without a lock. A look-up allocates nothing and never
/// throws.
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 0.0, 64);
/// const auto table_of = [&](double dimension) {
///     const auto start = comminute::mixed_fabric(comminute::power_law(dimension, 0.01, 1.0), grid);
///     return comminute::ResponseTable(comminute::QuasiStatic(grid, comminute::Material{}), start, 100.0);
/// };
/// const auto family = comminute::ResponseFamily::refined({2.0, 2.6}, table_of);
/// const auto d50 = family.percentile(50.0, 30.0, 2.35);
/// CHECK(d50.status == comminute::ResponseStatus::inside);
/// CHECK(d50.by_load < 0.0);                                               // crushing makes grains finer
/// CHECK(d50.by_variable < 0.0);                                           // a larger dimension has more fines
/// CHECK(family.crushes(30.0, 2.0).value == family.tables().front().crushes(30.0).value);
/// CHECK(family.crushes(30.0, 1.9).status == comminute::ResponseStatus::outside);
/// CHECK(comminute::ResponseFamily::from_bytes(family.to_bytes()) == family);
/// @endcode
class COMMINUTE_API ResponseFamily {
  public:
    /// @param values  (M) nodes, two or more, rising
    /// @param tables  (M) of each
    /// @throws ShapeError for another number of tables, ParameterError for values that do not rise, or tables that differ in
    ///         grid, largest load, largest grain, exact sizes or scalars
    ResponseFamily(std::vector<double> values, std::vector<ResponseTable> tables);

    /// Makes a table at each value and, wherever the family between two of them is off by more than the tolerance, at their
    /// mean.
    /// @param values  two or more, rising; the first and the last are the ends of the family
    /// @throws ParameterError as the constructor, and for a tolerance that takes more nodes than allowed
    static ResponseFamily refined(std::vector<double> values,
                                  const std::function<ResponseTable(double)>& table_at,
                                  const FamilyOptions& options = {});

    /// Takes back what `to_bytes` gave.
    /// @throws ParameterError for bytes that are no family, of another version, damaged or cut short
    static ResponseFamily from_bytes(VectorView<const unsigned char> bytes);
    /// Version, nodes, tables (little-endian) and a checksum.
    std::vector<unsigned char> to_bytes() const;

    const LogGrid& grid() const;
    /// (M) nodes.
    const std::vector<double>& values() const;
    const std::vector<ResponseTable>& tables() const;

    // The look-ups of a table, with a value of the second variable: `outside` beyond the first and the last node.
    FamilyResponse crushes(double stress_ratio, double value) const noexcept;
    FamilyResponse finer(Index bin, double stress_ratio, double value) const noexcept;
    FamilyResponse scalar(Index index, double stress_ratio, double value) const noexcept;
    FamilyResponse percentile(double percent, double stress_ratio, double value) const noexcept;
    /// @param cdf  (N) out: mass finer than the upper edge of each bin; untouched unless the status is `inside`
    /// @throws ShapeError for another size of `cdf`
    ResponseStatus grading(double stress_ratio, double value, VectorView<double> cdf) const;
    /// Mass that is still at the exact sizes of the start, fine to coarse; empty where nothing is known.
    std::vector<PointMass> points(double stress_ratio, double value) const;

    /// Bytes of memory, shared by all copies.
    std::size_t memory() const;

    friend COMMINUTE_API bool operator==(const ResponseFamily& a, const ResponseFamily& b);
    friend bool operator!=(const ResponseFamily& a, const ResponseFamily& b) { return !(a == b); }

  private:
    struct Data;
    std::shared_ptr<const Data> data_;
};

}  // namespace comminute
