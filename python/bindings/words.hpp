// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <utility>

#include "comminute/comminute.hpp"

/// The words by which Python names the library's choices.
template <class Choice>
struct Words;

template <>
struct Words<comminute::KernelKind> {
    static constexpr const char* parameter = "kind";
    static constexpr std::array<std::pair<const char*, comminute::KernelKind>, 4> list{
        {{"exact", comminute::KernelKind::exact},
         {"slow", comminute::KernelKind::slow},
         {"fast", comminute::KernelKind::fast},
         {"blend", comminute::KernelKind::blend}}};
};

template <>
struct Words<comminute::Mean> {
    static constexpr const char* parameter = "mean";
    static constexpr std::array<std::pair<const char*, comminute::Mean>, 2> list{
        {{"arithmetic", comminute::Mean::arithmetic}, {"geometric", comminute::Mean::geometric}}};
};

template <>
struct Words<comminute::Partners> {
    static constexpr const char* parameter = "partners";
    static constexpr std::array<std::pair<const char*, comminute::Partners>, 3> list{
        {{"permuted", comminute::Partners::permuted},
         {"shift", comminute::Partners::shift},
         {"locked", comminute::Partners::locked}}};
};

template <>
struct Words<comminute::ColumnEnd> {
    static constexpr const char* parameter = "end";
    static constexpr std::array<std::pair<const char*, comminute::ColumnEnd>, 4> list{
        {{"closed", comminute::ColumnEnd::closed},
         {"periodic", comminute::ColumnEnd::periodic},
         {"feed", comminute::ColumnEnd::feed},
         {"outflow", comminute::ColumnEnd::outflow}}};
};

template <>
struct Words<comminute::CrushOrder> {
    static constexpr const char* parameter = "order";
    static constexpr std::array<std::pair<const char*, comminute::CrushOrder>, 2> list{
        {{"random", comminute::CrushOrder::random}, {"weakest", comminute::CrushOrder::weakest}}};
};

template <>
struct Words<comminute::SwapRates> {
    static constexpr const char* parameter = "rates";
    static constexpr std::array<std::pair<const char*, comminute::SwapRates>, 2> list{
        {{"pair", comminute::SwapRates::pair}, {"flowslm", comminute::SwapRates::flowslm}}};
};

template <>
struct Words<comminute::Axis> {
    static constexpr const char* parameter = "exact";
    static constexpr std::array<std::pair<const char*, comminute::Axis>, 2> list{
        {{"grain", comminute::Axis::grain}, {"neighbour", comminute::Axis::neighbour}}};
};

template <>
struct Words<comminute::PointHandling> {
    static constexpr const char* parameter = "points";
    static constexpr std::array<std::pair<const char*, comminute::PointHandling>, 2> list{
        {{"exact", comminute::PointHandling::exact}, {"binned", comminute::PointHandling::binned}}};
};

template <>
struct Words<comminute::Scheme> {
    static constexpr const char* parameter = "scheme";
    static constexpr std::array<std::pair<const char*, comminute::Scheme>, 2> list{
        {{"conservative", comminute::Scheme::conservative}, {"paper", comminute::Scheme::paper}}};
};

template <>
struct Words<comminute::StressKind> {
    static constexpr const char* parameter = "stress_measure";
    static constexpr std::array<std::pair<const char*, comminute::StressKind>, 5> list{
        {{"largest", comminute::StressKind::largest},
         {"vertical", comminute::StressKind::largest},
         {"mean", comminute::StressKind::mean},
         {"octahedral", comminute::StressKind::octahedral},
         {"energy", comminute::StressKind::energy}}};
};

template <>
struct Words<comminute::SolvePath> {
    static constexpr const char* parameter = "path";
    static constexpr std::array<std::pair<const char*, comminute::SolvePath>, 6> list{
        {{"automatic", comminute::SolvePath::automatic},
         {"direct", comminute::SolvePath::direct},
         {"sums", comminute::SolvePath::sums},
         {"blend", comminute::SolvePath::blend},
         {"narrow", comminute::SolvePath::narrow},
         {"none", comminute::SolvePath::none}}};
};

template <>
struct Words<comminute::StepPath> {
    static constexpr const char* parameter = "path";
    static constexpr std::array<std::pair<const char*, comminute::StepPath>, 4> list{
        {{"automatic", comminute::StepPath::automatic},
         {"transforms", comminute::StepPath::transforms},
         {"sums", comminute::StepPath::sums},
         {"direct", comminute::StepPath::direct}}};
};

template <>
struct Words<comminute::PlanEffort> {
    static constexpr const char* parameter = "effort";
    static constexpr std::array<std::pair<const char*, comminute::PlanEffort>, 2> list{
        {{"estimate", comminute::PlanEffort::estimate}, {"measure", comminute::PlanEffort::measure}}};
};

/// A batch answers bad states by an exception for all, or leaves each as it was.
enum class BadStates { raise, keep };

template <>
struct Words<BadStates> {
    static constexpr const char* parameter = "bad_states";
    static constexpr std::array<std::pair<const char*, BadStates>, 2> list{
        {{"raise", BadStates::raise}, {"keep", BadStates::keep}}};
};

/// @throws comminute::ParameterError naming the parameter and the words it knows
template <class Choice>
Choice choice_of(const std::string& word) {
    std::string known;
    for (const auto& [name, value] : Words<Choice>::list) {
        if (word == name) return value;
        known += (known.empty() ? "" : ", ") + std::string("'") + name + "'";
    }
    throw comminute::ParameterError({.parameter = Words<Choice>::parameter,
                                     .value = "'" + word + "'",
                                     .rule = "it must be one of " + known});
}

template <class Choice>
const char* word_of(Choice choice) {
    for (const auto& [name, value] : Words<Choice>::list) {
        if (choice == value) return name;
    }
    return "";
}
