// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// COMMINUTE_API marks what a shared library of comminute exports; everything else stays inside it. A host that links
/// the static library on Windows defines COMMINUTE_STATIC; elsewhere the mark does no harm.
#if defined(_WIN32) && !defined(COMMINUTE_STATIC)
#if defined(comminute_EXPORTS)
#define COMMINUTE_API __declspec(dllexport)
#else
#define COMMINUTE_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define COMMINUTE_API __attribute__((visibility("default")))
#else
#define COMMINUTE_API
#endif
