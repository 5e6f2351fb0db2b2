// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>

namespace pcl_slim {

/** \brief The kind of defect an Error names. */
enum class ErrorCode {
  kOk,           ///< nothing went wrong
  kBadArgument,  ///< a parameter is outside its range
  kBadInput,     ///< the data cannot be worked on (empty, all non-finite, truncated, foreign)
  kIo,           ///< a file cannot be opened, read or written
  kCancelled,    ///< the caller stopped the run
  kNoSurface,    ///< the points are fine, but nowhere a surface: too few, along lines, scattered
};

/** \brief What went wrong, in one sentence that names the defect and the remedy.
 *
 * Modules return errors and never print. A default-constructed Error means success.
 */
struct [[nodiscard]] Error {
  ErrorCode code = ErrorCode::kOk;
  std::string message;

  /** \brief True when there is an error. */
  explicit operator bool() const { return code != ErrorCode::kOk; }
};

/** \brief An error of data that cannot be worked on. */
inline Error badInput(std::string message) {
  return {ErrorCode::kBadInput, std::move(message)};
}

/** \brief A value, or the error that kept it from being made. */
template <typename T>
class [[nodiscard]] Result {
 public:
  /** \brief A value. */
  Result(T value) : value_(std::move(value)) {}
  /** \brief An error, which must be one. */
  Result(Error error) : error_(std::move(error)) {}

  /** \brief True when there is a value. */
  explicit operator bool() const { return value_.has_value(); }
  /** \brief The error; none when there is a value. */
  const Error& error() const { return error_; }

  T& operator*() { return *value_; }
  const T& operator*() const { return *value_; }
  T* operator->() { return &*value_; }
  const T* operator->() const { return &*value_; }

 private:
  std::optional<T> value_;
  Error error_;
};

}  // namespace pcl_slim
