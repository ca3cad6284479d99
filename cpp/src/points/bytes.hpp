// SPDX-License-Identifier: BSD-3-Clause
// Numbers as bytes: a magic word, a version, the numbers low byte first, and a checksum of all before it
// (docs/guides/material_points.md).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "comminute/grid.hpp"
#include "comminute/view.hpp"

namespace comminute::detail {

/// Number that other numbers are unlikely to have.
std::uint64_t fingerprint(const double* numbers, std::size_t count);

/// Kind of the bytes, with which they begin.
struct ByteKind {
    std::array<unsigned char, 8> magic;
    std::uint64_t version;
    const char* name;  ///< noun of what they hold
};

/// Writes numbers one after another.
class ByteWriter {
  public:
    explicit ByteWriter(const ByteKind& kind);

    void number(std::uint64_t value);
    void real(double value);
    void single(float value);
    void reals(const std::vector<double>& values);
    void text(const std::string& words);
    void grid(const LogGrid& grid);
    /// The bytes with their checksum.
    std::vector<unsigned char> sealed();

  private:
    std::vector<unsigned char> bytes_;
};

/// Reads what a ByteWriter wrote. Everything that is wrong with the bytes is a ParameterError.
class ByteReader {
  public:
    /// Refuses bytes of another kind or version, damaged or cut short.
    ByteReader(const ByteKind& kind, VectorView<const unsigned char> bytes);

    std::uint64_t number();
    /// A number of entries.
    std::size_t size();
    double real();
    float single();
    std::vector<double> reals(std::size_t count);
    std::string text();
    LogGrid grid();
    /// Refuses bytes that go on.
    void require_end() const;
    [[noreturn]] void refuse(const std::string& finding) const;

  private:
    const unsigned char* take(std::size_t count);

    const char* name_;
    const unsigned char* bytes_;
    std::size_t count_;
    std::size_t at_;
};

}  // namespace comminute::detail
