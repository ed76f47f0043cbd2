#include "optim/mmc/problem/responses/rows.h"

namespace flexmorph::mmc {
namespace {

/// The response f = s V, where V is the mean of the mass factors over the domain: the volume
/// fraction (s = 1) or the mass (s = ρ c A [kg]).
class Volume final : public Response {
 public:
  Volume(const Plate& plate, double scale)
      : n_domain_cells_(plate.n_domain_cells()),
        scale_(scale),
        share_(MatrixXd::Constant(1, plate.grid.n_cells(), scale / n_domain_cells_)) {}

  void evaluate(const DesignView& at, Values& out) override {
    out.f = VectorXd::Constant(1, scale_ * (at.factors.mass.sum() / n_domain_cells_));
    out.d_mass = share_;
  }

 private:
  int n_domain_cells_;
  double scale_;
  MatrixXd share_;
};

double full_mass(const Plate& plate) { return plate.full_mass(); }

}  // namespace

const ResponseRow kVolume{.name = "volume",
                          .words = "volume",
                          .full = [](const Plate&) { return 1.0; },
                          .even = true,
                          .linear = true,
                          .make = [](const Plate& plate) -> std::unique_ptr<Response> {
                            return std::make_unique<Volume>(plate, 1.0);
                          }};

const ResponseRow kMass{.name = "mass",
                        .words = "mass",
                        .unit = "kg",
                        .full = full_mass,
                        .even = true,
                        .linear = true,
                        .make = [](const Plate& plate) -> std::unique_ptr<Response> {
                          return std::make_unique<Volume>(plate, plate.full_mass());
                        }};

}  // namespace flexmorph::mmc
