// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Functions so marked are compiled twice, for any x86-64 and for one with AVX2 and FMA, and the loader picks. The
// sanitizers' start-up code does not get along with that.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__x86_64__) || \
    !defined(__gnu_linux__) || !defined(__GNUC__) || defined(__clang__)
#define COMMINUTE_MULTIVERSION
#else
#define COMMINUTE_MULTIVERSION __attribute__((target_clones("arch=haswell", "default")))
#endif
