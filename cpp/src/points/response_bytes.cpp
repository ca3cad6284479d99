// SPDX-License-Identifier: BSD-3-Clause
// Response tables as bytes (docs/theory/response_tables.md).
#include <string>
#include <utility>

#include "comminute/response_table.hpp"
#include "points/bytes.hpp"
#include "points/response_data.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr ByteKind kind{{'c', 'm', 'r', 'e', 's', 'p', 'o', 'n'}, 1, "response table"};

}  // namespace

std::vector<unsigned char> ResponseTable::to_bytes() const {
    ByteWriter out(kind);
    out.grid(data_->grid);
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
    ByteReader in(kind, bytes);
    const LogGrid grid = in.grid();
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
    in.require_end();
    if (loads < 2) in.refuse("are damaged");
    return ResponseTable(std::move(data));
}

}  // namespace comminute
