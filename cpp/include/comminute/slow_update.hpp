// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "comminute/export.hpp"
#include "comminute/kernel.hpp"

namespace comminute {

/// Choices of a SlowUpdate.
struct SlowUpdateOptions {
    Scheme scheme = Scheme::conservative;  ///< of the fragments; zones are tested at bin centres under either
    friend bool operator==(const SlowUpdateOptions& a, const SlowUpdateOptions& b) {
        return a.scheme == b.scheme;
    }
};

/// One step of the slow kernel (Eq. 63) that looks only at the band of the zone and spreads only the cells in
/// it that hold mass, each along its row or column (Section 8.2). Equal to FullConvolution with the slow
/// kernel.
///
/// Costs one look at the band plus O(N) for each active cell: where the state was at rest and the load has risen a
/// little, those are the O(N) cells at the zone's boundary. Where so many cells hold mass that running sums, O(K N^2),
/// cost less, and the fragments' law has them, the step uses these; the report's `terms` is then K. Never makes a negative
/// entry. Owns its workspace (up to one state); one object per thread, and a copy has a workspace of its own. A step
/// allocates nothing.
///
/// @throws ParameterError for a bad material
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 1.0, 64);
/// comminute::SlowUpdate engine(grid, comminute::Material{});
/// std::vector<double> p(64 * 64, 0.0);
/// p[60 * 64 + 59] = 1.0;
/// comminute::MatrixView<double> state(p.data(), 64, 64);
/// CHECK(engine.step(state, 100.0, state).crushed == 1.0);
/// CHECK(std::accumulate(p.begin(), p.end(), 0.0) == doctest::Approx(1.0));
/// @endcode
class COMMINUTE_API SlowUpdate {
  public:
    SlowUpdate(const LogGrid& grid, const Material& material, const SlowUpdateOptions& options = {});
    ~SlowUpdate();
    SlowUpdate(const SlowUpdate& other);
    SlowUpdate& operator=(const SlowUpdate& other);
    SlowUpdate(SlowUpdate&&) noexcept;
    SlowUpdate& operator=(SlowUpdate&&) noexcept;

    /// @param p    (N, N) state before the step; active entries must be finite
    /// @param out  (N, N) state after it; may be p itself, and is then updated in place
    /// @throws ShapeError for other shapes or a partial overlap, ParameterError for a bad load or an active entry that
    ///         is not finite; `out` is then untouched
    StepReport step(MatrixView<const double> p, double stress_ratio, MatrixView<double> out);

    const LogGrid& grid() const;
    const Material& material() const;
    const SlowUpdateOptions& options() const;
    /// The slow kernel of these options.
    const Kernel& kernel() const;

  private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace comminute
