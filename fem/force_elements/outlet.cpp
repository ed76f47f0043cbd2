
#include "fem/line_grid.h"
#include "fem/reservoir_matrices.h"

namespace flexmorph::fem {
namespace {

/// Number of Gauss points on the line across one element; N_oᵀ r_m has degree 4.
constexpr int kPoints = 3;

/// See make_outlet(). With the unknowns q of the body and Q_k of the elements of the plate at the
/// root
///
///   f = s K q̇ - s² B q + s² Σ G_k Q_k
///   K = ρc ∫ (N_oᵀ N_o - N_sᵀ N_s) dy,   G_k = ρc ∫ N_oᵀ N_k,m dy
class Outlet final : public ForceElement, public MeanForceElement {
 public:
  Outlet(std::string name, std::string body, std::string plate, const MaterialReservoir& reservoirs)
      : name_(std::move(name)),
        body_(std::move(body)),
        plate_(std::move(plate)),
        reservoirs_(reservoirs),
        moved_(mass_across(reservoirs, reservoirs.outlet) - mass_across(reservoirs, reservoirs.at)),
        slide_(
            sliding_matrix(reservoirs.area_density * reservoirs.width, reservoirs.at, reservoirs)) {
    check(reservoirs);
  }

  std::unique_ptr<ForceElement> clone() const override { return std::make_unique<Outlet>(*this); }
  std::string name() const override { return name_; }

  void bind(std::span<const BodyView> bodies) override {
    const std::string user = "outlet '" + name_ + "'";
    const BodyView &body = find_body(bodies, user, body_), &plate = find_body(bodies, user, plate_);
    grid_ = dynamic_cast<const LineGrid*>(plate.element);
    if (!body.element->is_rigid() || !grid_ || grid_->dim() != 2)
      throw Error::input(user + ": it must join a rigid body and a plate in the plane");
    first_ = body.first_dof;
    locations_.clear();
    for (int j = 0; j < grid_->n_n(); ++j)
      for (const int vector : grid_->vectors(grid_->element(0, j)))
        locations_.push_back(plate.first_dof + 2 * vector);
    slopes_.resize(locations_.size());
  }

  void add_force(const State& x, VectorXd& out) const override {
    out.segment<4>(first_) += force(x);
  }
  void add_pattern(std::vector<Eigen::Triplet<double>>& out) const override {
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) out.emplace_back(first_ + i, first_ + j, 0);
    for (const int location : locations_)
      for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 2; ++c) out.emplace_back(first_ + i, location + c, 0);
  }
  void add_tangent(const State& x, const Weights& w,
                   std::vector<Eigen::Triplet<double>>& out) const override {
    const double s = speed(x.t);
    find_directions();
    const Eigen::Matrix4d own = w.v * s * moved_ - w.q * s * s * slide_;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) out.emplace_back(first_ + i, first_ + j, own(i, j));
    for (size_t k = 0; k < locations_.size(); ++k)
      for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 2; ++c)
          out.emplace_back(first_ + i, locations_[k] + c, w.q * s * s * slopes_[k](i, c));
  }
  // The mean force is the force at the mean state, as for the inertia of the plate.
  void add_mean_force(const State& mean, const VectorXd&, const VectorXd&,
                      VectorXd& out) const override {
    add_force(mean, out);
  }
  void add_mean_tangent(const State& mean, const VectorXd&, const VectorXd&, const Weights& w,
                        std::vector<Eigen::Triplet<double>>& out) const override {
    add_tangent(mean, w, out);
  }
  double power(const State& x) const override { return -force(x).dot(x.v.segment<4>(first_)); }

 private:
  using Block = Eigen::Matrix<double, 4, 2>;

  double speed(double t) const { return -reservoirs_.length(t).rate; }

  Eigen::Vector4d force(const State& x) const {
    const double s = speed(x.t);
    find_directions();
    Eigen::Vector4d out = -slide_ * x.q.segment<4>(first_);
    for (size_t k = 0; k < locations_.size(); ++k)
      out += slopes_[k] * x.q.segment<2>(locations_[k]);
    return s * s * out + s * (moved_ * x.v.segment<4>(first_));
  }

  /// Computes G_k for the current positions of the lines of the mesh.
  void find_directions() const {
    static thread_local ShapeTable table;
    const Vec2 axis = axis_of(reservoirs_), across(-axis.y(), axis.x());
    const GaussRule& rule = gauss(kPoints);
    size_t k = 0;
    for (int j = 0; j < grid_->n_n(); ++j) {
      const int e = grid_->element(0, j);
      const double low = grid_->line_n(j).value, width = grid_->line_n(j + 1).value - low;
      const auto n = static_cast<size_t>(grid_->vectors(e).size());
      for (size_t l = 0; l < n; ++l) slopes_[k + l].setZero();
      for (size_t g = 0; g < kPoints; ++g) {
        grid_->at(e, 0, rule.points[g], Tabulate::gradient, table);
        const Vec2 point = reservoirs_.outlet + (low + rule.points[g] * width) * across;
        Block at;
        at << Eigen::Matrix2d::Identity(), arm_of(point).transpose();
        at *= reservoirs_.area_density * width * rule.weights[g];
        for (size_t l = 0; l < n; ++l)
          slopes_[k + l] += table.N_m(0, static_cast<Eigen::Index>(l)) * at;
      }
      k += n;
    }
  }

  std::string name_, body_, plate_;
  MaterialReservoir reservoirs_;
  Eigen::Matrix4d moved_, slide_;  // K and B
  const LineGrid* grid_ = nullptr;
  int first_ = 0;  // first unknown of the body
  // First unknowns of the vectors of the elements at the root, element by element.
  std::vector<int> locations_;
  mutable std::vector<Block> slopes_;  // G_k
};

}  // namespace

std::unique_ptr<ForceElement> make_outlet(std::string name, std::string body, std::string plate,
                                          const MaterialReservoir& reservoirs) {
  return std::make_unique<Outlet>(std::move(name), std::move(body), std::move(plate), reservoirs);
}

}  // namespace flexmorph::fem
