// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/grading.hpp"
#include "comminute/quasi_static.hpp"
#include "comminute/view.hpp"

namespace comminute {

/// How finely a response table follows the load.
struct ResponseOptions {
    double tolerance = 1e-4;  ///< > 0, error of the mass finer than a size between the loads of the table
    Index most_loads = 4000;  ///< >= 8, above which a table that needs more is refused
};

/// Place of a load in a response table.
enum class ResponseStatus : unsigned char {
    inside,     ///< in the table, or below the first crush, where the start is as it was
    above,      ///< above its largest load: the value is NaN
    bad_load,   ///< NaN or negative: the value is NaN
    in_fines,   ///< a percentile in the fines bin, where no size is known: the value is NaN
    no_scalar,  ///< a scalar that the table does not have: the value is NaN
    outside,    ///< a value of a family's second variable beyond its first or last node: the number is NaN
};

/// A number under a load, and its derivative by the stress ratio.
struct Response {
    double value;
    double derivative;
    ResponseStatus status;
};

/// Settled gradings of one packing against the load: all that a closed material point which starts from this packing has to
/// know, since its largest load decides its grading.
///
/// The loads follow the response to a stated tolerance, an error of the mass finer than each edge of a bin. In between, every
/// number is a monotone cubic in ln(stress ratio) (Fritsch and Butland 1984, SIAM J. Sci. Stat. Comput. 5, 300), so that
/// what only rises in the model only rises here. Where equal grains crush at once the response jumps, and so does the table,
/// within 1e-9 of ln(stress ratio). Percentiles are read from the interpolated grading, and jump where it has exact sizes.
///
/// A table is immutable: copies are cheap and threads share it without a lock. A look-up allocates nothing, takes a binary
/// search over some hundred loads, and never throws: its status says whether the load is one that the table knows.
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 0.0, 64);
/// comminute::QuasiStatic solver(grid, comminute::Material{});
/// const auto start = comminute::mixed_fabric(comminute::power_law(2.5, 0.01, 1.0), grid);
/// const comminute::ResponseTable table(solver, start, 1000.0);
/// const auto d50 = table.percentile(50.0, 100.0);
/// CHECK(d50.status == comminute::ResponseStatus::inside);
/// CHECK(d50.derivative < 0.0);                                          // crushing makes grains finer
/// CHECK(table.crushes(0.5).value == 0.0);                               // below the first crush
/// CHECK(table.percentile(50.0, 2000.0).status == comminute::ResponseStatus::above);
/// CHECK(comminute::ResponseTable::from_bytes(table.to_bytes()) == table);
/// @endcode
class COMMINUTE_API ResponseTable {
  public:
    /// Follows a packing up to a load.
    /// @param solver            takes the packing from load to load; only its grid, material and options matter
    /// @param start             a packing on the solver's grid, at rest under no load
    /// @param max_stress_ratio  > 0 and finite
    /// @throws ParameterError for a start that has been loaded, a load or an option outside its range, or a tolerance that
    ///         takes more loads than allowed
    ResponseTable(QuasiStatic solver, const Fabric& start, double max_stress_ratio,
                  const ResponseOptions& options = {});

    /// Takes back what `to_bytes` gave.
    /// @throws ParameterError for bytes that are no table, of another version, damaged or cut short
    static ResponseTable from_bytes(VectorView<const unsigned char> bytes);
    /// Version, numbers (little-endian) and a checksum.
    std::vector<unsigned char> to_bytes() const;

    /// The same table with one more number for each of its loads, to be looked up by `scalar`.
    /// @param at_loads  (T) finite values at `stress_ratios`
    /// @throws ShapeError for another number of values, ParameterError for a name it has or a value that is not finite
    ResponseTable with_scalar(const std::string& name, const std::vector<double>& at_loads) const;

    const LogGrid& grid() const;
    const ResponseOptions& options() const;
    /// (T) loads of the table, rising; at the first nothing has crushed.
    std::vector<double> stress_ratios() const;
    /// Names of the scalars, in the order in which they were added.
    std::vector<std::string> scalars() const;
    /// Index of a scalar for `scalar`; -1 for one that it does not have.
    Index index_of(const std::string& name) const;
    /// Size that no grain exceeds.
    double largest() const;

    /// Mean number of crushes a cell has been through.
    Response crushes(double stress_ratio) const noexcept;
    /// Mass finer than the upper edge of a bin, 0 <= bin < N.
    Response finer(Index bin, double stress_ratio) const noexcept;
    /// A scalar by its index.
    Response scalar(Index index, double stress_ratio) const noexcept;
    /// Size D_x such that `percent` of the mass is finer, in [0, 100]; see `percentile` of a grading.
    Response percentile(double percent, double stress_ratio) const noexcept;
    /// Whole grading.
    /// @param cdf  (N) out: mass finer than the upper edge of each bin; untouched unless the status is `inside`
    /// @throws ShapeError for another size of `cdf`
    ResponseStatus grading(double stress_ratio, VectorView<double> cdf) const;
    /// Mass that is still at the exact sizes of the start, fine to coarse; empty for a load that the table does not know.
    std::vector<PointMass> points(double stress_ratio) const;

    /// Bytes of memory, shared by all copies.
    std::size_t memory() const;

    friend COMMINUTE_API bool operator==(const ResponseTable& a, const ResponseTable& b);
    friend bool operator!=(const ResponseTable& a, const ResponseTable& b) { return !(a == b); }

  private:
    struct Data;
    explicit ResponseTable(std::shared_ptr<const Data> data);
    std::shared_ptr<const Data> data_;
};

}  // namespace comminute
