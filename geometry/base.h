#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>

/// The words all folders speak: vectors, and the one error type.
namespace flexmorph {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

/// The one exception of Flexmorph.
///
/// input      what the user wrote cannot be used (exit code 2)
/// numerical  a computation failed; what was computed before stays (exit code 3)
class Error : public std::runtime_error {
 public:
  enum class Kind { input, numerical };

  Error(Kind kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}

  static Error input(const std::string& what) { return {Kind::input, what}; }
  static Error numerical(const std::string& what) { return {Kind::numerical, what}; }

  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

}  // namespace flexmorph
