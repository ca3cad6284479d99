// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "comminute/column_drive.hpp"

namespace comminute::detail {

/// @throws ShapeError, ParameterError for a time or a drive outside its range
void require_column_drive(double time, const ColumnDrive& drive, Index rows);

}  // namespace comminute::detail
