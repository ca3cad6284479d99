// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/error.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace comminute {

namespace {

struct RemedyWords {
    Remedy remedy;
    const char* name;
    const char* words;
};

constexpr std::array<RemedyWords, 22> remedy_words{{
    {Remedy::normalise, "normalise", "divide it by its sum"},
    {Remedy::raise_psi_max, "raise_psi_max", "raise psi_max"},
    {Remedy::size_grid_automatically, "size_grid_automatically",
     "raise psi_max, or size the grid from the grading with fitting_grid"},
    {Remedy::lower_psi_min, "lower_psi_min", "lower psi_min to resolve it"},
    {Remedy::resolve_fines, "resolve_fines", "lower psi_min to resolve it, or set extrapolate"},
    {Remedy::extrapolate, "extrapolate", "add finer sieves, or set extrapolate to follow the tail"},
    {Remedy::cumulate_masses, "cumulate_masses", "pass the mass fraction finer, not the mass of each bin"},
    {Remedy::cumulate_retained, "cumulate_retained",
     "retained percentages? convert them to per cent finer first"},
    {Remedy::extend_top, "extend_top",
     "add the size that all grains pass, or set extend_top to carry the last slope on to 100 %"},
    {Remedy::add_coarser_sieve, "add_coarser_sieve", "add the size that all grains pass"},
    {Remedy::add_finer_sieve, "add_finer_sieve", "add a size with 0 % finer"},
    {Remedy::set_first_crush_stress, "set_first_crush_stress",
     "set it on the Material, or give stress_ratio"},
    {Remedy::set_stress_measure, "set_stress_measure",
     "set Material::stress_measure, the measure in which first_crush_stress is known"},
    {Remedy::use_same_grid, "use_same_grid", "make the solver with fabric.grid()"},
    {Remedy::use_blend_kernel, "use_blend_kernel", "use KernelKind::blend, or leave loading_rate at 0"},
    {Remedy::choose_path, "choose_path", "use the path automatic, or transforms"},
    {Remedy::record_avalanches, "record_avalanches", "set record_avalanches when the lattice is made"},
    {Remedy::use_own_memory, "use_own_memory", "pass memory of its own"},
    {Remedy::order_rows, "order_rows", "pass rows that follow each other without gaps"},
    {Remedy::leave_out, "leave_out", "leave it out"},
    {Remedy::build_with_fftw, "build_with_fftw",
     "install libfftw3-dev and build with -DCOMMINUTE_WITH_FFTW=ON, or use SlowUpdate, which needs none"},
    {Remedy::use_lattice_or_resolved, "use_lattice_or_resolved", "take a Lattice or a Resolved"},
}};

const RemedyWords* entry_of(Remedy remedy) {
    const auto found = std::find_if(remedy_words.begin(), remedy_words.end(),
                                    [remedy](const RemedyWords& entry) { return entry.remedy == remedy; });
    return found == remedy_words.end() ? nullptr : &*found;
}

std::string capitalised(std::string sentence) {
    if (!sentence.empty() && sentence[0] >= 'a' && sentence[0] <= 'z') {
        sentence[0] = static_cast<char>(sentence[0] - 'a' + 'A');
    }
    return sentence;
}

std::string digits_of(double value, int precision) {
    std::array<char, 32> digits{};
    char* end = digits.data() + digits.size();
    const auto result = precision == 0
                            ? std::to_chars(digits.data(), end, value)
                            : std::to_chars(digits.data(), end, value, std::chars_format::general, precision);
    return {digits.data(), result.ptr};
}

std::string what_of(const Fault& fault) {
    return message(fault, words_of(fault.remedy));
}

}  // namespace

std::vector<Remedy> remedies() {
    std::vector<Remedy> all;
    all.reserve(remedy_words.size());
    for (const RemedyWords& entry : remedy_words) all.push_back(entry.remedy);
    return all;
}

std::string name_of(Remedy remedy) {
    const RemedyWords* entry = entry_of(remedy);
    return entry == nullptr ? "" : entry->name;
}

std::string words_of(Remedy remedy) {
    const RemedyWords* entry = entry_of(remedy);
    return entry == nullptr ? "" : entry->words;
}

std::string text(const Place& place) {
    std::string out = place.name;
    for (std::size_t d = 0; d < place.index.size(); ++d) {
        out += (d == 0 ? "[" : ", ") + std::to_string(place.index[d]);
    }
    if (!place.index.empty()) out += "]";
    if (place.row > 0) out += (out.empty() ? "row " : " row ") + std::to_string(place.row);
    if (!place.column.empty()) out += ", column " + place.column;
    return out;
}

std::string message(const Fault& fault, const std::string& remedy) {
    std::string out;
    std::string subject = fault.parameter;
    for (std::size_t step = 0; step < fault.place.size(); ++step) {
        const Place& place = fault.place[step];
        if (step + 1 == fault.place.size() && place.name == fault.parameter) {
            subject = text(place);
        } else {
            out += text(place) + ": ";
        }
    }
    out += fault.subject.empty() ? subject : fault.subject;
    if (!fault.finding.empty()) {
        out += " " + fault.finding;
    } else if (!fault.value.empty()) {
        out += " is " + fault.value;
    }
    if (fault.also) out += " " + text(*fault.also);
    if (!fault.rule.empty()) out += "; " + fault.rule;
    if (remedy.empty()) return out;
    return out + (fault.rule.empty() ? "; " + remedy : ". " + capitalised(remedy));
}

Fault within(Place outer, Fault fault) {
    fault.place.insert(fault.place.begin(), std::move(outer));
    return fault;
}

Faulty::Faulty(Fault fault) : fault_(std::make_shared<const Fault>(std::move(fault))) {}
ParameterError::ParameterError(const Fault& fault) : std::invalid_argument(what_of(fault)), Faulty(fault) {}
ShapeError::ShapeError(const Fault& fault) : std::invalid_argument(what_of(fault)), Faulty(fault) {}
UnavailableError::UnavailableError(const Fault& fault) : std::runtime_error(what_of(fault)), Faulty(fault) {}

std::string text(double value) {
    return digits_of(value, 0);
}

std::string rounded(double value) {
    return digits_of(value, 6);
}

void require(bool ok, const char* parameter, double value, const char* rule) {
    if (ok) return;
    throw ParameterError({.parameter = parameter,
                          .value = text(value),
                          .number = value,
                          .rule = std::string("it must be ") + rule});
}

}  // namespace comminute
