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

/// Many states and the load of each, as a host code's material points have them.
struct Batch {
    StackView<const double> states;         ///< (B, N, N)
    VectorView<const double> stress_ratio;  ///< (B)
    VectorView<const double>
        settled_at;  ///< (B) load under which each is at rest, 0: never loaded; empty: none was
};

struct BatchOptions {
    Index threads = 1;  ///< at most so many at a time, each with a workspace of its own
    /// Asked some times a second; if it answers false (or throws) the batch stops there, with some states written.
    std::function<bool()> go_on;
};

/// QuasiStatic for many states on one grid and material.
///
/// Gives for each state the very bits that QuasiStatic gives, whatever the number of threads. States that share their
/// loads take turns and share the crush zones too, so a few loads for many states cost less. Starts no thread unless
/// asked; each takes some tens of microseconds to start, so they pay from some hundred small states on.
///
/// Begin-state in, end-state out; in place too. One object for one caller at a time.
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 0.0, 32);
/// comminute::BatchSolver solver(comminute::QuasiStatic(grid, comminute::Material{}));
/// std::vector<double> states(2 * 32 * 32, 1.0 / (32 * 32));        // of two material points
/// std::vector<double> load{10.0, 100.0}, settled_at{0.0, 0.0};
/// comminute::StackView<double> points(states.data(), 2, 32);
/// std::vector<comminute::SolveReport> reports(2);
/// solver.solve({points, load, settled_at}, points, reports);       // in place
/// settled_at = load;                                               // all that a point has to remember
/// CHECK(reports[1].crushed > reports[0].crushed);
/// CHECK(reports[0].crushed > 0.0);
/// @endcode
class COMMINUTE_API BatchSolver {
  public:
    /// @param solver  copied for every thread
    explicit BatchSolver(QuasiStatic solver);

    const QuasiStatic& solver() const { return workers_.front(); }

    /// @param out      (B, N, N) states at rest under the larger of `stress_ratio` and `settled_at`; may be
    ///                 `batch.states` itself
    /// @param reports  (B), or empty
    /// @return         whether it came to the end
    /// @throws ShapeError for sizes that do not fit or a partial overlap; ParameterError, naming the first index, for a
    ///         bad load or an entry in the crush zone that is not finite. All this before anything is written; only
    ///         masses so large that their sum overflows are found on the way
    bool solve(const Batch& batch, StackView<double> out, VectorView<SolveReport> reports = {nullptr, 0},
               const BatchOptions& options = {});

    /// @param grainsize  (B, N) mass by grainsize after it; may not overlap the states
    /// @throws           as solve()
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
