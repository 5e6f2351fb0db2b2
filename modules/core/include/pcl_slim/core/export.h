// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/** \brief Marks what the shared libraries export. Everything else is hidden. */
#if defined(__GNUC__)
#define PCL_SLIM_EXPORT __attribute__((visibility("default")))
#else
#define PCL_SLIM_EXPORT
#endif
