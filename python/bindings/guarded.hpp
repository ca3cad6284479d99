// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <utility>

#include "bindings.hpp"

/// A lattice or a column behind a lock, since the GIL does not guard it while it is loaded.
template <class Model>
class Guarded {
  public:
    explicit Guarded(Model model) : model_(std::move(model)) {}

    /// Calls f(model) without the GIL, alone.
    template <class F>
    auto with(const F& f) {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return f(model_);
    }

  private:
    Model model_;
    std::mutex mutex_;
};
