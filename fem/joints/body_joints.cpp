#include "fem/body_joints.h"

#include <cmath>

#include "fem/joints/pair_joint.h"

namespace flexmorph::fem {
namespace {

using Values = MarkerPair::Values;
using Part = MarkerPair::Part;
constexpr Part kPositionA = MarkerPair::kPositionA, kAxisA = MarkerPair::kAxisA,
               kPositionB = MarkerPair::kPositionB, kAxisB = MarkerPair::kAxisB;

/// The number c (x × z) + s (x · z) of two vectors x, z in y. With (c, s) = (cos, sin) of an angle,
/// it is x × z after z was turned by that angle.
struct Turned {
  double value;
  Values gradient = Values::Zero();

  Turned(const Values& y, Part i, Part j, double c, double s) {
    const Vec2 x = y.segment<2>(i), z = y.segment<2>(j);
    const Vec2 turned(c * z.y() + s * z.x(), s * z.y() - c * z.x());
    value = x.dot(turned);
    gradient.segment<2>(i) = turned;
    gradient.segment<2>(j) += Vec2(s * x.x() - c * x.y(), c * x.x() + s * x.y());
  }
};

/// Sets the second derivatives of a Turned number.
void put_turned(Part i, Part j, double c, double s, MarkerPair::Square& f_yy) {
  Eigen::Matrix2d block;
  block << s, c, -c, s;
  f_yy.block<2, 2>(i, j) = block;
  f_yy.block<2, 2>(j, i) = block.transpose();
}

/// Fills the two rows p_b - p_a.
void fill_difference(const Values& y, PairRow* rows) {
  for (int c = 0; c < 2; ++c) {
    rows[c].f = y[kPositionB + c] - y[kPositionA + c];
    rows[c].f_y[kPositionB + c] = 1;
    rows[c].f_y[kPositionA + c] = -1;
  }
}

/// Fills the row n_a · e_b = e_a × e_b.
void fill_parallel(const Values& y, PairRow& row) {
  const Turned cross(y, kAxisA, kAxisB, 1, 0);
  row.f = cross.value;
  row.f_y = cross.gradient;
  put_turned(kAxisA, kAxisB, 1, 0, row.f_yy);
}

constexpr unsigned entry(Part part, int component) { return 1U << (part + component); }

class UnitAxis final : public PairJoint {
 public:
  UnitAxis(std::string name, std::string body)
      : PairJoint(std::move(name), {.body = std::move(body)}, {},
                  {{bits({kAxisA})}, {{kAxisA, kAxisA}}}) {}
  std::unique_ptr<Joint> clone() const override { return std::make_unique<UnitAxis>(*this); }
  bool belongs_to_body() const override { return true; }

 private:
  void fill(double, const Values& y, std::vector<PairRow>& rows) const override {
    const auto u = y.segment<2>(kAxisA);
    rows[0].f = 0.5 * (u.squaredNorm() - 1);
    rows[0].f_y.segment<2>(kAxisA) = u;
    rows[0].f_yy.block<2, 2>(kAxisA, kAxisA).setIdentity();
  }
};

class Revolute final : public PairJoint {
 public:
  Revolute(std::string name, MarkerLocation a, MarkerLocation b)
      : PairJoint(std::move(name), std::move(a), std::move(b),
                  {{entry(kPositionA, 0) | entry(kPositionB, 0),
                    entry(kPositionA, 1) | entry(kPositionB, 1)}}) {}

 private:
  std::unique_ptr<Joint> clone() const override { return std::make_unique<Revolute>(*this); }
  void fill(double, const Values& y, std::vector<PairRow>& rows) const override {
    fill_difference(y, rows.data());
  }
};

class RigidWeld final : public PairJoint {
 public:
  RigidWeld(std::string name, MarkerLocation a, MarkerLocation b)
      : PairJoint(std::move(name), std::move(a), std::move(b),
                  {{entry(kPositionA, 0) | entry(kPositionB, 0),
                    entry(kPositionA, 1) | entry(kPositionB, 1), bits({kAxisA, kAxisB})},
                   {{kAxisA, kAxisB}}}) {}

 private:
  std::unique_ptr<Joint> clone() const override { return std::make_unique<RigidWeld>(*this); }
  void fill(double, const Values& y, std::vector<PairRow>& rows) const override {
    fill_difference(y, rows.data());
    fill_parallel(y, rows[2]);
  }
};

class Slider final : public PairJoint {
 public:
  Slider(std::string name, MarkerLocation a, MarkerLocation b)
      : PairJoint(std::move(name), std::move(a), std::move(b),
                  {{bits({kAxisA, kPositionA, kPositionB}), bits({kAxisA, kAxisB})},
                   {{kAxisA, kPositionA}, {kAxisA, kPositionB}, {kAxisA, kAxisB}}}) {}

 private:
  std::unique_ptr<Joint> clone() const override { return std::make_unique<Slider>(*this); }
  void fill(double, const Values& y, std::vector<PairRow>& rows) const override {
    const Turned a(y, kAxisA, kPositionA, 1, 0), b(y, kAxisA, kPositionB, 1, 0);
    rows[0].f = b.value - a.value;
    rows[0].f_y = b.gradient - a.gradient;
    put_turned(kAxisA, kPositionA, -1, 0, rows[0].f_yy);
    put_turned(kAxisA, kPositionB, 1, 0, rows[0].f_yy);
    fill_parallel(y, rows[1]);
  }
};

std::function<Motion(double)> present(const std::string& joint,
                                      std::function<Motion(double)> motion) {
  if (!motion) throw Error::input("joint '" + joint + "': its prescribed motion is missing");
  return motion;
}

class AngleDrive final : public PairJoint {
 public:
  AngleDrive(std::string name, MarkerLocation a, MarkerLocation b,
             std::function<Motion(double)> motion)
      : PairJoint(name, std::move(a), std::move(b), {{bits({kAxisA, kAxisB})}, {{kAxisA, kAxisB}}}),
        motion_(present(name, std::move(motion))) {}

 private:
  std::unique_ptr<Joint> clone() const override { return std::make_unique<AngleDrive>(*this); }
  /// Fills the row n_b · R(α) e_a = e_b × R(α) e_a.
  void fill(double t, const Values& y, std::vector<PairRow>& rows) const override {
    const Motion alpha = motion_(t);
    const double c = std::cos(alpha.value), s = std::sin(alpha.value);
    const Turned f(y, kAxisB, kAxisA, c, s), by_alpha(y, kAxisB, kAxisA, -s, c);
    PairRow& row = rows[0];
    row.f = f.value;
    row.f_t = alpha.rate * by_alpha.value;
    row.f_tt = alpha.acceleration * by_alpha.value - alpha.rate * alpha.rate * f.value;
    row.f_y = f.gradient;
    row.f_yt = alpha.rate * by_alpha.gradient;
    put_turned(kAxisB, kAxisA, c, s, row.f_yy);
  }

  std::function<Motion(double)> motion_;
};

class Distance final : public PairJoint {
 public:
  Distance(const std::string& name, MarkerLocation a, MarkerLocation b,
           std::function<Motion(double)> motion)
      : PairJoint(name, std::move(a), std::move(b),
                  {{bits({kPositionA, kPositionB})},
                   {{kPositionA, kPositionA}, {kPositionA, kPositionB}, {kPositionB, kPositionB}}}),
        motion_(present(name, std::move(motion))),
        start_(motion_(0).value) {
    check(name, start_);
  }

 private:
  static void check(const std::string& name, double length) {
    if (!(length > 0) || !std::isfinite(length))
      throw Error::input("joint '" + name + "': its distance is " + std::to_string(length) +
                         " m; a distance must be positive");
  }

  std::unique_ptr<Joint> clone() const override { return std::make_unique<Distance>(*this); }
  void fill(double t, const Values& y, std::vector<PairRow>& rows) const override {
    const Motion length = motion_(t);
    check(name(), length.value);
    const Vec2 d = y.segment<2>(kPositionB) - y.segment<2>(kPositionA);
    PairRow& row = rows[0];
    row.f = 0.5 * (d.squaredNorm() - length.value * length.value) / start_;
    row.f_t = -length.value * length.rate / start_;
    row.f_tt = -(length.rate * length.rate + length.value * length.acceleration) / start_;
    row.f_y.segment<2>(kPositionB) = d / start_;
    row.f_y.segment<2>(kPositionA) = -d / start_;
    const Eigen::Matrix2d one = Eigen::Matrix2d::Identity() / start_;
    row.f_yy.block<2, 2>(kPositionA, kPositionA) = one;
    row.f_yy.block<2, 2>(kPositionB, kPositionB) = one;
    row.f_yy.block<2, 2>(kPositionA, kPositionB) = -one;
    row.f_yy.block<2, 2>(kPositionB, kPositionA) = -one;
  }

  std::function<Motion(double)> motion_;
  double start_;  // L(0)
};

class PointDriven final : public PairJoint {
 public:
  PointDriven(const std::string& name, MarkerLocation a, PointDrive point,
              std::vector<int> components)
      : PairJoint(name, std::move(a), {}, {rows_of(name, components)}),
        point_(std::move(point)),
        components_(std::move(components)) {
    if (!point_) throw Error::input("joint '" + name + "': its prescribed motion is missing");
  }

 private:
  static std::vector<unsigned> rows_of(const std::string& name,
                                       const std::vector<int>& components) {
    std::vector<unsigned> out;
    for (const int c : components) {
      if (c != 0 && c != 1)
        throw Error::input("joint '" + name + "': component " + std::to_string(c) +
                           " does not exist; a point in the plane has the components 0 and 1");
      out.push_back(entry(kPositionA, c));
    }
    return out;
  }

  std::unique_ptr<Joint> clone() const override { return std::make_unique<PointDriven>(*this); }
  void fill(double t, const Values& y, std::vector<PairRow>& rows) const override {
    const std::vector<Motion> drive = point_(t);
    if (drive.size() != rows.size())
      throw Error::input("joint '" + name() + "': its drive has " + std::to_string(drive.size()) +
                         " components, but " + std::to_string(rows.size()) + " are needed");
    for (size_t i = 0; i < rows.size(); ++i) {
      const int c = components_[i];
      rows[i].f = y[kPositionA + c] - drive[i].value;
      rows[i].f_t = -drive[i].rate;
      rows[i].f_tt = -drive[i].acceleration;
      rows[i].f_y[kPositionA + c] = 1;
    }
  }

  PointDrive point_;
  std::vector<int> components_;
};

}  // namespace

std::unique_ptr<Joint> make_unit_axis(std::string name, std::string body) {
  return std::make_unique<UnitAxis>(std::move(name), std::move(body));
}

std::unique_ptr<Joint> make_revolute(std::string name, MarkerLocation a, MarkerLocation b) {
  return std::make_unique<Revolute>(std::move(name), std::move(a), std::move(b));
}

std::unique_ptr<Joint> make_rigid_weld(std::string name, MarkerLocation a, MarkerLocation b) {
  return std::make_unique<RigidWeld>(std::move(name), std::move(a), std::move(b));
}

std::unique_ptr<Joint> make_slider(std::string name, MarkerLocation a, MarkerLocation b) {
  return std::make_unique<Slider>(std::move(name), std::move(a), std::move(b));
}

std::unique_ptr<Joint> make_angle_drive(std::string name, MarkerLocation a, MarkerLocation b,
                                        std::function<Motion(double)> motion) {
  return std::make_unique<AngleDrive>(std::move(name), std::move(a), std::move(b),
                                      std::move(motion));
}

std::unique_ptr<Joint> make_distance(std::string name, MarkerLocation a, MarkerLocation b,
                                     std::function<Motion(double)> motion) {
  return std::make_unique<Distance>(std::move(name), std::move(a), std::move(b), std::move(motion));
}

std::unique_ptr<Joint> make_point_drive(std::string name, MarkerLocation a, PointDrive point,
                                        std::vector<int> components) {
  if (components.empty()) components = {0, 1};
  return std::make_unique<PointDriven>(std::move(name), std::move(a), std::move(point),
                                       std::move(components));
}

}  // namespace flexmorph::fem
