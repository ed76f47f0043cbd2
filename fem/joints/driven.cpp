#include <cmath>

#include "fem/joint.h"
#include "fem/joints/weld_rows.h"

namespace flexmorph::fem {
namespace {

class Weld final : public Joint {
 public:
  Weld(std::string name, std::string body, std::string edge, FrameDrive frame, WeldMode mode)
      : name_(std::move(name)),
        body_(std::move(body)),
        edge_(std::move(edge)),
        frame_(std::move(frame)),
        mode_(mode) {}

  std::unique_ptr<Joint> clone() const override { return std::make_unique<Weld>(*this); }
  std::string name() const override { return name_; }
  int size() const override { return static_cast<int>(fixed_.size() + along_.size()); }

  void bind(std::span<const BodyView> bodies) override {
    const BodyView& body = find_body(bodies, name_, body_);
    const int dim = body.element->dim();
    const WeldRows rows = weld_rows(*body.element, body.element->edge(edge_), mode_, name_);
    fixed_.clear();
    along_.clear();
    for (const WeldRows::Fixed& x : rows.fixed)
      for (int c = 0; c < 2; ++c)
        fixed_.push_back({body.first_dof + dim * x.vector + c, c, x.moves, x.local});
    for (const int vector : rows.flat)
      fixed_.push_back({body.first_dof + dim * vector + 2, 2, 0, {0, 0}});
    for (const WeldRows::Along& x : rows.along)
      along_.push_back({body.first_dof + dim * x.vector, x.normal});
  }

  void evaluate(double t, const VectorXd& q, const VectorXd& v,
                ConstraintRows& rows) const override {
    const FrameMotion f = frame_(t);
    Eigen::Matrix2d turn;  // columns e₁, e₂
    turn << std::cos(f.angle), -std::sin(f.angle), std::sin(f.angle), std::cos(f.angle);
    Eigen::Matrix2d quarter;
    quarter << 0, -1, 1, 0;
    const Eigen::Matrix2d turn_t = f.angle_rate * quarter * turn;
    const Eigen::Matrix2d turn_tt =
        f.angle_acceleration * quarter * turn - f.angle_rate * f.angle_rate * turn;

    rows.value.resize(size());
    rows.rate.resize(size());
    rows.acceleration.resize(size());
    rows.jacobian.clear();
    int i = 0;
    for (const Fixed& x : fixed_) {
      if (x.direction == 2) {  // normal to the plane in which the frame turns
        rows.value[i] = q[x.dof];
        rows.rate[i] = rows.acceleration[i] = 0;
        rows.jacobian.emplace_back(i++, x.dof, 1.0);
        continue;
      }
      rows.value[i] =
          q[x.dof] - x.moves * f.origin[x.direction] - turn.row(x.direction).dot(x.local);
      rows.rate[i] = -x.moves * f.origin_rate[x.direction] - turn_t.row(x.direction).dot(x.local);
      rows.acceleration[i] =
          x.moves * f.origin_acceleration[x.direction] + turn_tt.row(x.direction).dot(x.local);
      rows.jacobian.emplace_back(i, x.dof, 1.0);
      ++i;
    }
    for (const auto& [dof, normal] : along_) {
      const auto x = q.segment<2>(dof), x_t = v.segment<2>(dof);
      const Vec2 n = turn * normal, n_t = turn_t * normal, n_tt = turn_tt * normal;
      rows.value[i] = n.dot(x);
      rows.rate[i] = n_t.dot(x);
      rows.acceleration[i] = -n_tt.dot(x) - 2 * n_t.dot(x_t);
      for (int c = 0; c < 2; ++c) rows.jacobian.emplace_back(i, dof + c, n[c]);
      ++i;
    }
  }

 private:
  /// One entry of a vector equals a coordinate of a vector given in the frame.
  struct Fixed {
    int dof, direction;
    double moves;  // 1 if the vector starts at the origin of the frame, else 0
    Vec2 local;
  };
  /// A vector has no component along a direction given in the frame.
  struct Along {
    int dof;  // first unknown of the vector
    Vec2 normal;
  };

  std::string name_, body_, edge_;
  FrameDrive frame_;
  WeldMode mode_;
  std::vector<Fixed> fixed_;
  std::vector<Along> along_;
};

class Pin final : public Joint {
 public:
  Pin(std::string name, std::string body, const Vec2& material, PointDrive point,
      std::vector<int> components)
      : name_(std::move(name)),
        body_(std::move(body)),
        material_(material),
        point_(std::move(point)),
        components_(std::move(components)),
        all_(components_.empty()) {}

  std::unique_ptr<Joint> clone() const override { return std::make_unique<Pin>(*this); }
  std::string name() const override { return name_; }
  int size() const override { return static_cast<int>(components_.size()); }

  void bind(std::span<const BodyView> bodies) override {
    const BodyView& body = find_body(bodies, name_, body_);
    const Element& element = *body.element;
    ShapeTable table;
    const int e = element.locate(material_, Tabulate::position, table);
    if (element.moving(e))
      throw Error::input("joint '" + name_ +
                         "': a pin cannot be in an element whose material lines move");
    if (all_) {
      components_.clear();
      for (int c = 0; c < element.dim(); ++c) components_.push_back(c);
    }
    for (const int c : components_)
      if (c < 0 || c >= element.dim())
        throw Error::input("joint '" + name_ + "': component " + std::to_string(c) +
                           " does not exist; the body has " + std::to_string(element.dim()) +
                           " dimensions");
    const auto vectors = element.vectors(e);
    terms_.clear();
    for (int k = 0; k < element.n_shapes(); ++k)
      terms_.emplace_back(body.first_dof + element.dim() * vectors[static_cast<size_t>(k)],
                          table.N(0, k));
  }

  void evaluate(double t, const VectorXd& q, const VectorXd&, ConstraintRows& rows) const override {
    const std::vector<Motion> drive = point_(t);
    if (static_cast<int>(drive.size()) != size())
      throw Error::input("joint '" + name_ + "': its drive has " + std::to_string(drive.size()) +
                         " components, but " + std::to_string(size()) + " are needed");
    rows.value.resize(size());
    rows.rate.resize(size());
    rows.acceleration.resize(size());
    rows.jacobian.clear();
    for (int i = 0; i < size(); ++i) {
      const Motion& x = drive[static_cast<size_t>(i)];
      rows.value[i] = -x.value;
      rows.rate[i] = -x.rate;
      rows.acceleration[i] = x.acceleration;
    }
    for (const auto& [dof, weight] : terms_)
      for (int i = 0; i < size(); ++i) {
        const int c = components_[static_cast<size_t>(i)];
        rows.value[i] += weight * q[dof + c];
        rows.jacobian.emplace_back(i, dof + c, weight);
      }
  }

 private:
  std::string name_, body_;
  Vec2 material_;
  PointDrive point_;
  std::vector<int> components_;
  bool all_;  // true if all components of the body are prescribed
  std::vector<std::pair<int, double>> terms_;
};

}  // namespace

const BodyView& find_body(std::span<const BodyView> bodies, const std::string& joint,
                          const std::string& body) {
  for (const BodyView& b : bodies)
    if (*b.name == body) return b;
  throw Error::input("joint '" + joint + "': there is no body '" + body + "'");
}

std::unique_ptr<Joint> make_weld(std::string name, std::string body, std::string edge,
                                 FrameDrive frame, WeldMode mode) {
  return std::make_unique<Weld>(std::move(name), std::move(body), std::move(edge), std::move(frame),
                                mode);
}

std::unique_ptr<Joint> make_pin(std::string name, std::string body, const Vec2& material,
                                FrameDrive point) {
  PointDrive origin = [frame = std::move(point)](double t) {
    const FrameMotion f = frame(t);
    return std::vector<Motion>{{f.origin.x(), f.origin_rate.x(), f.origin_acceleration.x()},
                               {f.origin.y(), f.origin_rate.y(), f.origin_acceleration.y()}};
  };
  return make_pin(std::move(name), std::move(body), material, std::move(origin), {0, 1});
}

std::unique_ptr<Joint> make_pin(std::string name, std::string body, const Vec2& material,
                                PointDrive point, std::vector<int> components) {
  return std::make_unique<Pin>(std::move(name), std::move(body), material, std::move(point),
                               std::move(components));
}

}  // namespace flexmorph::fem
