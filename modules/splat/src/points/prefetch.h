// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Asks for the cache line of an address. Not a function, which GCC takes for one without effect.
#if defined(__GNUC__)
#define PCL_SLIM_PREFETCH(address) __builtin_prefetch(address)
#else
#define PCL_SLIM_PREFETCH(address) static_cast<void>(address)
#endif
