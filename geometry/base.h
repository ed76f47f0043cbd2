#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>

/// Vectors and the error type that all folders use.
namespace flexmorph {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Vec2 = Eigen::Vector2d;  ///< Point or vector in the plane; lengths are in metres.
using Vec3 = Eigen::Vector3d;  ///< Point or vector in space; lengths are in metres.

/// The exception type that Flexmorph throws for all errors it reports to the user.
///
///   input      the input of the user cannot be used (exit code 2)
///   numerical  a computation failed; results written before the failure are kept (exit code 3)
class Error : public std::runtime_error {
 public:
  /// Cause of an error, which determines the exit code of the program.
  enum class Kind { input, numerical };

  /// Creates an error of a kind with the message for the user.
  Error(Kind kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}

  /// Returns an error that the input of the user caused.
  static Error input(const std::string& what) { return {Kind::input, what}; }
  /// Returns an error for a computation that failed.
  static Error numerical(const std::string& what) { return {Kind::numerical, what}; }

  /// Returns the kind of the error.
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

}  // namespace flexmorph
