// SPDX-License-Identifier: BSD-3-Clause
// Bytes that tell what they are and whether they are whole (docs/guides/material_points.md).
#include "points/bytes.hpp"

#include <algorithm>
#include <cstring>

#include "comminute/error.hpp"

namespace comminute::detail {
namespace {

constexpr std::uint64_t most_entries = 1U << 28;  // of any list, so that damage cannot ask for all memory
constexpr std::size_t head_size = 16;             // magic word and version
constexpr std::size_t seal_size = 8;

/// FNV-1a: guards against accidents, not against forgers.
std::uint64_t checksum(const unsigned char* bytes, std::size_t count) {
    std::uint64_t hash = 0xCBF29CE484222325U;
    for (std::size_t i = 0; i < count; ++i) hash = (hash ^ bytes[i]) * 0x100000001B3U;
    return hash;
}

template <class Unsigned>
Unsigned unsigned_at(const unsigned char* from) {
    Unsigned value = 0;
    for (std::size_t byte = 0; byte < sizeof value; ++byte) {
        value |= static_cast<Unsigned>(static_cast<Unsigned>(from[byte]) << (8 * byte));
    }
    return value;
}

template <class To, class From>
To same_bits(From from) {
    static_assert(sizeof(To) == sizeof(From));
    To to{};
    std::memcpy(&to, &from, sizeof to);
    return to;
}

template <class Unsigned>
void append(std::vector<unsigned char>& bytes, Unsigned value) {
    for (std::size_t byte = 0; byte < sizeof value; ++byte) {
        bytes.push_back(static_cast<unsigned char>(value >> (8 * byte)));
    }
}

}  // namespace

std::uint64_t fingerprint(const double* numbers, std::size_t count) {
    std::vector<unsigned char> bytes;
    bytes.reserve(8 * count);
    for (std::size_t k = 0; k < count; ++k) append(bytes, same_bits<std::uint64_t>(numbers[k]));
    return checksum(bytes.data(), bytes.size());
}

ByteWriter::ByteWriter(const ByteKind& kind) {
    for (const unsigned char byte : kind.magic) bytes_.push_back(byte);
    number(kind.version);
}

void ByteWriter::number(std::uint64_t value) {
    append(bytes_, value);
}
void ByteWriter::real(double value) {
    append(bytes_, same_bits<std::uint64_t>(value));
}
void ByteWriter::single(float value) {
    append(bytes_, same_bits<std::uint32_t>(value));
}
void ByteWriter::reals(const std::vector<double>& values) {
    for (const double value : values) real(value);
}
void ByteWriter::text(const std::string& words) {
    number(words.size());
    for (const char c : words) bytes_.push_back(static_cast<unsigned char>(c));
}
void ByteWriter::grid(const LogGrid& grid) {
    real(grid.psi_min());
    real(grid.psi_max());
    number(static_cast<std::uint64_t>(grid.bins()));
}
std::vector<unsigned char> ByteWriter::sealed() {
    number(checksum(bytes_.data(), bytes_.size()));
    return std::move(bytes_);
}

ByteReader::ByteReader(const ByteKind& kind, VectorView<const unsigned char> bytes)
    : name_(kind.name), bytes_(bytes.data()), count_(static_cast<std::size_t>(bytes.size())), at_(head_size) {
    if (count_ < head_size + seal_size || !std::equal(kind.magic.begin(), kind.magic.end(), bytes_))
        refuse(std::string("are no ") + name_);
    const auto version = unsigned_at<std::uint64_t>(bytes_ + kind.magic.size());
    if (version != kind.version)
        refuse("are of version " + std::to_string(version) + ", and this library reads " +
               std::to_string(kind.version));
    count_ -= seal_size;
    if (unsigned_at<std::uint64_t>(bytes_ + count_) != checksum(bytes_, count_))
        refuse("are damaged or cut short");
}

void ByteReader::refuse(const std::string& finding) const {
    throw ParameterError({.parameter = "bytes",
                          .finding = finding,
                          .rule = std::string("give what was written of a ") + name_});
}

const unsigned char* ByteReader::take(std::size_t count) {
    if (count > count_ - at_) refuse("are cut short");
    at_ += count;
    return bytes_ + at_ - count;
}

std::uint64_t ByteReader::number() {
    return unsigned_at<std::uint64_t>(take(8));
}
std::size_t ByteReader::size() {
    const std::uint64_t value = number();
    if (value > most_entries) refuse("are damaged");
    return static_cast<std::size_t>(value);
}
double ByteReader::real() {
    return same_bits<double>(number());
}
float ByteReader::single() {
    return same_bits<float>(unsigned_at<std::uint32_t>(take(4)));
}
std::vector<double> ByteReader::reals(std::size_t count) {
    if (count > (count_ - at_) / 8) refuse("are cut short");
    std::vector<double> values(count);
    for (double& value : values) value = real();
    return values;
}
std::string ByteReader::text() {
    const std::size_t length = size();
    const unsigned char* from = take(length);
    return {from, from + length};
}
LogGrid ByteReader::grid() {
    const double psi_min = real();
    const double psi_max = real();
    return {psi_min, psi_max, static_cast<Index>(size())};
}
void ByteReader::require_end() const {
    if (at_ != count_) refuse("are damaged");
}

}  // namespace comminute::detail
