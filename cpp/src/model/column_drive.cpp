// SPDX-License-Identifier: BSD-3-Clause
#include "model/column_drive.hpp"

#include <cmath>

#include "base/check.hpp"

namespace comminute::detail {

void require_column_drive(double time, const ColumnDrive& drive, Index rows) {
    require(time >= 0.0 && std::isfinite(time), "time", time, "at least 0 and finite");
    require_entries(drive.shear_rate.size(), rows, entry("shear_rate"), "it must have one for each row");
    for (Index z = 0; z < rows; ++z)
        require(drive.shear_rate[z] >= 0.0 && std::isfinite(drive.shear_rate[z]), "shear_rate",
                drive.shear_rate[z], "at least 0 and finite");
    require(drive.mixing >= 0.0 && std::isfinite(drive.mixing), "mixing", drive.mixing,
            "at least 0 and finite");
    require(drive.shear_mixing >= 0.0 && std::isfinite(drive.shear_mixing), "shear_mixing",
            drive.shear_mixing, "at least 0 and finite");
    require(drive.segregation >= 0.0 && std::isfinite(drive.segregation), "segregation", drive.segregation,
            "at least 0 and finite");
    require(drive.crush_rate >= 0.0, "crush_rate", drive.crush_rate, "at least 0 (inf: at once)");
}

}  // namespace comminute::detail
