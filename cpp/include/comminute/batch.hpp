// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <type_traits>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/quasi_static.hpp"

namespace comminute {

/// Borrowed square matrices of one size: `stack[b]` is the b-th, `stride` numbers after the one before it.
template <class T>
class StackView {
  public:
    StackView(T* data, Index count, Index bins) : StackView(data, count, bins, bins * bins) {}
    StackView(T* data, Index count, Index bins, Index stride)
        : data_(data), count_(count), bins_(bins), stride_(stride) {}
    template <class U, class = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
    StackView(StackView<U> other) : StackView(other.data(), other.count(), other.bins(), other.stride()) {}

    T* data() const { return data_; }
    Index count() const { return count_; }
    Index bins() const { return bins_; }
    Index stride() const { return stride_; }
    MatrixView<T> operator[](Index b) const { return {data_ + b * stride_, bins_, bins_}; }

  private:
    T* data_;
    Index count_;
    Index bins_;
    Index stride_;
};

/// Many states and the load of each, such as the material points of a host code.
struct Batch {
    StackView<const double> states;         ///< (B, N, N)
    VectorView<const double> stress_ratio;  ///< (B)
    /// (B) load under which each state is at rest, 0 for one that was never loaded; empty if none ever was
    VectorView<const double> settled_at;
};

/// How a batch is run.
struct BatchOptions {
    Index threads = 1;  ///< >= 1, largest number of threads, each with a workspace of its own
    /// Called a few times a second; if it returns false or throws, the batch stops there, with some states written.
    std::function<bool()> go_on;
};

/// QuasiStatic for many states on one grid and material.
///
/// The result for each state equals that of QuasiStatic bit by bit, whatever the number of threads. States with the same
/// loads are solved one after the other and share the crush zones, so that many states under a few loads cost less. By
/// default it starts no thread; each takes some tens of microseconds to start, which pays from some hundred small states
/// on.
///
/// Begin-state in, end-state out, also in place. One object serves one caller at a time.
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 0.0, 32);
/// comminute::BatchSolver solver(comminute::QuasiStatic(grid, comminute::Material{}));
/// std::vector<double> states(2 * 32 * 32, 1.0 / (32 * 32));        // of two material points
/// std::vector<double> load{10.0, 100.0}, settled_at{0.0, 0.0};
/// comminute::StackView<double> points(states.data(), 2, 32);
/// std::vector<comminute::SolveReport> reports(2);
/// solver.solve({points, load, settled_at}, points, reports);       // in place
/// settled_at = load;                                               // what a point has to remember
/// CHECK(reports[1].crushed > reports[0].crushed);
/// CHECK(reports[0].crushed > 0.0);
/// @endcode
class COMMINUTE_API BatchSolver {
  public:
    /// Takes grid, material and options from a solver.
    /// @param solver  copied for every thread
    explicit BatchSolver(QuasiStatic solver);

    const QuasiStatic& solver() const { return workers_.front(); }

    /// Brings every state to rest.
    /// @param out      (B, N, N) states at rest under the larger of `stress_ratio` and `settled_at`; may be
    ///                 `batch.states` itself
    /// @param reports  (B) out; empty to skip
    /// @return         whether all states were solved; false where `go_on` stopped the batch
    /// @throws ShapeError for sizes that do not fit or a partial overlap; ParameterError, naming the first index, for a
    ///         bad load or an entry in the crush zone that is not finite. Both are thrown before anything is written;
    ///         only masses so large that their sum overflows are found on the way
    bool solve(const Batch& batch, StackView<double> out, VectorView<SolveReport> reports = {nullptr, 0},
               const BatchOptions& options = {});

    /// Computes the grading of every state at rest, without the state.
    /// @param grainsize  (B, N) out: mass by grainsize; may not overlap the states
    /// @return, @throws  as solve()
    bool marginal(const Batch& batch, MatrixView<double> grainsize,
                  VectorView<SolveReport> reports = {nullptr, 0}, const BatchOptions& options = {});

  private:
    using Work = std::function<void(QuasiStatic& worker, Index turn)>;

    void require_fit(const Batch& batch, VectorView<SolveReport> reports, const BatchOptions& options) const;
    bool run(const Batch& batch, const BatchOptions& options, const Work& work);
    bool for_each_state(Index count, const BatchOptions& options, const Work& work);

    std::vector<QuasiStatic> workers_;
};

}  // namespace comminute
