// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

#include "comminute/view.hpp"

namespace comminute::detail {

/// A std::vector whose size and index are signed, as every index of the grid is.
template <class T, class Allocator = std::allocator<T>>
class Array {
  public:
    using Storage = std::vector<T, Allocator>;

    Array() = default;
    explicit Array(Index size, const T& value = T()) : values_(static_cast<std::size_t>(size), value) {}
    Array(std::initializer_list<T> values) : values_(values) {}
    explicit Array(Storage values) : values_(std::move(values)) {}

    Index size() const { return static_cast<Index>(values_.size()); }
    bool empty() const { return values_.empty(); }
    T* data() { return values_.data(); }
    const T* data() const { return values_.data(); }
    T& operator[](Index i) { return values_[static_cast<std::size_t>(i)]; }
    const T& operator[](Index i) const { return values_[static_cast<std::size_t>(i)]; }
    auto begin() { return values_.begin(); }
    auto end() { return values_.end(); }
    auto begin() const { return values_.begin(); }
    auto end() const { return values_.end(); }
    T& back() { return values_.back(); }
    const T& back() const { return values_.back(); }

    void assign(Index size, const T& value) { values_.assign(static_cast<std::size_t>(size), value); }
    void resize(Index size) { values_.resize(static_cast<std::size_t>(size)); }
    void reserve(Index size) { values_.reserve(static_cast<std::size_t>(size)); }
    void clear() { values_.clear(); }
    void push_back(T value) { values_.push_back(std::move(value)); }

    /// The vector itself, for what is handed to the public interface.
    const Storage& vector() const& { return values_; }
    Storage&& vector() && { return std::move(values_); }

  private:
    Storage values_;
};

/// Entry of a standard container by signed index.
template <class Container>
auto& at(Container& values, Index i) {
    return values[static_cast<std::size_t>(i)];
}

/// Borrowed numbers side by side as an Eigen array: sums, products and comparisons entry by entry.
using Line = Eigen::Map<Eigen::ArrayXd>;
using ConstLine = Eigen::Map<const Eigen::ArrayXd>;

}  // namespace comminute::detail
