// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Everything. From a host's CMake: find_package(comminute) and link comminute::comminute.

#include "comminute/batch.hpp"
#include "comminute/criterion.hpp"
#include "comminute/error.hpp"
#include "comminute/fabric.hpp"
#include "comminute/fragments.hpp"
#include "comminute/full_convolution.hpp"
#include "comminute/grading.hpp"
#include "comminute/grid.hpp"
#include "comminute/kernel.hpp"
#include "comminute/lattice.hpp"
#include "comminute/material.hpp"
#include "comminute/material_points.hpp"
#include "comminute/quasi_static.hpp"
#include "comminute/resolved.hpp"
#include "comminute/resolved_batch.hpp"
#include "comminute/resolved_grid.hpp"
#include "comminute/response_family.hpp"
#include "comminute/response_table.hpp"
#include "comminute/scheme.hpp"
#include "comminute/settle.hpp"
#include "comminute/slow_update.hpp"
#include "comminute/stress.hpp"
#include "comminute/version.hpp"
#include "comminute/view.hpp"
