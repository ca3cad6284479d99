// SPDX-License-Identifier: BSD-3-Clause
// Response tables as bytes: a magic word, a version, numbers low byte first, and a checksum of all before it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>

#include "comminute/error.hpp"
#include "comminute/response_table.hpp"
#include "points/response_data.hpp"

namespace comminute {

using namespace detail;

namespace {

using Bytes = std::vector<unsigned char>;

constexpr std::array<unsigned char, 8> magic{'c', 'm', 'r', 'e', 's', 'p', 'o', 'n'};
constexpr std::uint64_t version = 1;
constexpr std::uint64_t most_entries = 1U << 28;  // of any list, so that damage cannot ask for all memory

/// FNV-1a: guards against accidents, not against forgers.
std::uint64_t checksum(const unsigned char* bytes, std::size_t count) {
    std::uint64_t hash = 0xCBF29CE484222325U;
    for (std::size_t i = 0; i < count; ++i) hash = (hash ^ bytes[i]) * 0x100000001B3U;
    return hash;
}

class Writer {
  public:
    void number(std::uint64_t value) {
        for (int byte = 0; byte < 8; ++byte)
            bytes_.push_back(static_cast<unsigned char>(value >> (8 * byte)));
    }
    void real(double value) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        number(bits);
    }
    void reals(const std::vector<double>& values) {
        for (const double value : values) real(value);
    }
    template <class Range>
    void raw(const Range& range) {
        for (const unsigned char byte : range) bytes_.push_back(byte);
    }
    void text(const std::string& words) {
        number(words.size());
        for (const char c : words) bytes_.push_back(static_cast<unsigned char>(c));
    }
    Bytes sealed() {
        number(checksum(bytes_.data(), bytes_.size()));
        return std::move(bytes_);
    }

  private:
    Bytes bytes_;
};

[[noreturn]] void refuse(const std::string& finding) {
    throw ParameterError({.parameter = "bytes", .finding = finding, .rule = "give what to_bytes gave"});
}

class Reader {
  public:
    Reader(const unsigned char* bytes, std::size_t count) : bytes_(bytes), count_(count) {}

    std::uint64_t number() {
        const unsigned char* from = take(8);
        std::uint64_t value = 0;
        for (int byte = 0; byte < 8; ++byte) value |= static_cast<std::uint64_t>(from[byte]) << (8 * byte);
        return value;
    }
    std::size_t size() {
        const std::uint64_t value = number();
        if (value > most_entries) refuse("are damaged");
        return static_cast<std::size_t>(value);
    }
    double real() {
        const std::uint64_t bits = number();
        double value = 0.0;
        std::memcpy(&value, &bits, sizeof value);
        return value;
    }
    std::vector<double> reals(std::size_t count) {
        if (count > (count_ - at_) / 8) refuse("are cut short");
        std::vector<double> values(count);
        for (double& value : values) value = real();
        return values;
    }
    std::string text() {
        const std::size_t length = size();
        const unsigned char* from = take(length);
        return {from, from + length};
    }
    bool at_end() const { return at_ == count_; }

  private:
    const unsigned char* take(std::size_t count) {
        if (count > count_ - at_) refuse("are cut short");
        at_ += count;
        return bytes_ + at_ - count;
    }

    const unsigned char* bytes_;
    std::size_t count_;
    std::size_t at_ = 0;
};

}  // namespace

std::vector<unsigned char> ResponseTable::to_bytes() const {
    Writer out;
    out.raw(magic);
    out.number(version);
    out.real(data_->grid.psi_min());
    out.real(data_->grid.psi_max());
    out.number(static_cast<std::uint64_t>(data_->grid.bins()));
    out.real(data_->options.tolerance);
    out.number(static_cast<std::uint64_t>(data_->options.most_loads));
    out.real(data_->largest);
    out.real(data_->most);
    out.number(data_->exact.size());
    for (const PointMass& point : data_->exact) out.reals({point.psi, point.size});
    out.number(data_->names.size());
    for (const std::string& name : data_->names) out.text(name);
    out.number(data_->columns.at.size());
    out.reals(data_->columns.at);
    for (const std::vector<double>& column : data_->columns.values) out.reals(column);
    return out.sealed();
}

ResponseTable ResponseTable::from_bytes(VectorView<const unsigned char> bytes) {
    const auto count = static_cast<std::size_t>(bytes.size());
    if (count < magic.size() + 16 || !std::equal(magic.begin(), magic.end(), bytes.begin()))
        refuse("are no response table");
    Reader version_of(bytes.data() + magic.size(), 8);
    if (const std::uint64_t found = version_of.number(); found != version)
        refuse("are of version " + std::to_string(found) + ", and this library reads " +
               std::to_string(version));
    Reader seal(bytes.data() + count - 8, 8);
    if (seal.number() != checksum(bytes.data(), count - 8)) refuse("are damaged or cut short");
    Reader in(bytes.data() + magic.size() + 8, count - magic.size() - 16);
    const double psi_min = in.real();
    const double psi_max = in.real();
    const LogGrid grid(psi_min, psi_max, static_cast<Index>(in.size()));
    ResponseOptions options;
    options.tolerance = in.real();
    options.most_loads = static_cast<Index>(in.size());
    const double largest = in.real();
    const double most = in.real();
    std::vector<PointMass> exact;
    for (std::size_t left = in.size(); left > 0; --left) {
        const double psi = in.real();
        exact.push_back({psi, 0.0, in.real()});
    }
    auto data = std::make_shared<Data>(grid, options, largest, most, exact);
    data->names.resize(in.size());
    for (std::string& name : data->names) name = in.text();
    const std::size_t loads = in.size();
    data->columns.at = in.reals(loads);
    const auto fixed = static_cast<std::size_t>(grid.bins()) + exact.size() + 1;
    for (std::size_t j = 0; j < fixed + data->names.size(); ++j) data->columns.add(in.reals(loads));
    if (!in.at_end() || loads < 2) refuse("are damaged");
    return ResponseTable(std::move(data));
}

}  // namespace comminute
