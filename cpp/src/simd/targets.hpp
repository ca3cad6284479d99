// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Instruction sets that the vector loops are compiled for. Every file that includes Highway includes this one first, so
// that all of them agree.
//
// x86-64 has four: the baseline that every such machine runs, SSE4 (registers of 2 doubles), AVX2 (4) and AVX3, which is
// Highway's name for AVX-512 (8). SSSE3 and AVX3_DL are left out: they do nothing for doubles that their neighbours do
// not. 64-bit Arm has NEON (2). SVE and RVV are left out because the loops keep arrays of registers, which needs
// registers of a size known to the compiler; NEON of 32-bit Arm because it has no doubles.
#include <hwy/detect_compiler_arch.h>
#if HWY_ARCH_ARM_V7
#define HWY_DISABLED_TARGETS (HWY_NEON)
#else
#define HWY_DISABLED_TARGETS \
    (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif

#include <hwy/targets.h>
