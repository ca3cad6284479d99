// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <type_traits>
#include <vector>

namespace comminute {

/// Signed, so that differences of bin indices need no care.
using Index = std::ptrdiff_t;

/// A borrowed, contiguous run of numbers; `VectorView<const double>` may not be written through.
template <class T>
class VectorView {
  public:
    VectorView(T* data, Index size) : data_(data), size_(size) {}
    template <class U, class = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
    VectorView(VectorView<U> other) : data_(other.data()), size_(other.size()) {}
    VectorView(std::vector<std::remove_const_t<T>>& v)
        : data_(v.data()), size_(static_cast<Index>(v.size())) {}
    template <class U = T, class = std::enable_if_t<std::is_const_v<U>>>
    VectorView(const std::vector<std::remove_const_t<T>>& v)
        : data_(v.data()), size_(static_cast<Index>(v.size())) {}

    T* data() const { return data_; }
    Index size() const { return size_; }
    T& operator[](Index i) const { return data_[i]; }
    T* begin() const { return data_; }
    T* end() const { return data_ + size_; }

  private:
    T* data_;
    Index size_;
};

/// A borrowed matrix, row after row, `stride` numbers from one row to the next (at least `cols`).
///
/// The library's matrices are indexed `[i, j]` = `[psi, psibar]`, both growing with size.
///
/// @code{.cpp}
/// std::vector<double> storage(6, 0.0);
/// comminute::MatrixView<double> m(storage.data(), 2, 3);
/// m(1, 2) = 5.0;
/// CHECK(storage[5] == 5.0);
/// @endcode
template <class T>
class MatrixView {
  public:
    MatrixView(T* data, Index rows, Index cols) : MatrixView(data, rows, cols, cols) {}
    MatrixView(T* data, Index rows, Index cols, Index stride)
        : data_(data), rows_(rows), cols_(cols), stride_(stride) {}
    template <class U, class = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
    MatrixView(MatrixView<U> other) : MatrixView(other.data(), other.rows(), other.cols(), other.stride()) {}

    T* data() const { return data_; }
    Index rows() const { return rows_; }
    Index cols() const { return cols_; }
    Index stride() const { return stride_; }
    T* row(Index i) const { return data_ + i * stride_; }
    T& operator()(Index i, Index j) const { return data_[i * stride_ + j]; }

  private:
    T* data_;
    Index rows_;
    Index cols_;
    Index stride_;
};

}  // namespace comminute
