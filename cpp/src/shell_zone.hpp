// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "comminute/grid.hpp"
#include "comminute/material.hpp"

namespace comminute {

/// Log size of the smallest grain that crushes among equals under a load, the tip of the zone.
double zone_onset(const Material& material, double log_stress_ratio);

/// The slow crush zone across the cells of one shell, in lengths of bins. With the larger grain at t from its bin's
/// centre, t in [-1/2, 1/2], the zone's half-width is omega(t) = sqrt(steepness (t - tip)), tip the place of its onset.
class ShellZone {
  public:
    /// @param steepness  k / h, k of Eq. 15; inf where the fabric is off
    /// @param root       of the steepness
    ShellZone(double tip, double steepness, double root);

    /// Share of the area of the cell at |i - j| = distance that lies inside, with no error but rounding.
    double share(Index distance) const;
    /// The same for a run of distances.
    void shares(Index first, Index last, double* share) const;
    /// Number of distances, from 0 on, whose cells surely lie inside as a whole; at most at_most + 1.
    Index surely_whole(Index at_most) const;
    /// Distance, at most at_most, beyond which cells surely lie outside; -1 where all of them do.
    Index surely_last(Index at_most) const;

  private:
    /// Values of s - s_begin, s = sqrt(t - tip).
    struct Piece {
        double from = 0.0;
        double to = 0.0;
        bool empty() const { return !(to > from); }
    };
    double from_begin(double step) const { return step * (2.0 * s_begin_ + step); }  // t - begin
    Piece wider_than(double distance) const;
    template <class Length>
    double integral(const Piece& piece, const Length& length) const;
    double share_between(double distance, const Piece& some, const Piece& all) const;

    double tip_;
    double steepness_;
    double root_;
    double begin_;  // of the zone within the shell
    double s_begin_ = 0.0;
    double s_length_ = 0.0;
};

/// The zone under one load, shell by shell.
class ShellZones {
  public:
    ShellZones(const LogGrid& grid, const Material& material, double log_stress_ratio);

    ShellZone operator[](Index m) const { return {tip_ - static_cast<double>(m), steepness_, root_}; }

  private:
    double tip_;  // of shell 0
    double steepness_;
    double root_;
};

}  // namespace comminute
