#include "optim/mmc/problem/response.h"

/// Complete example of a response: the first moment of the material about the left edge, as
/// objective or limit.
namespace flexmorph::mmc {
namespace {

class FirstMoment final : public Response {
 public:
  explicit FirstMoment(const Plate& plate) : arm_(1, plate.grid.n_cells()) {
    const Grid& g = plate.grid;
    const double full = plate.section.density * plate.section.thickness * g.dx() * g.dy();
    for (int i = 0; i < g.nx; ++i)
      for (int j = 0; j < g.ny; ++j) arm_(g.cell(i, j)) = full * (g.cell_center(i, j).x() - g.x0);
  }
  void evaluate(const DesignView& at, Values& out) override {
    out.f = arm_ * at.factors.mass;
    out.d_mass = arm_;
  }

 private:
  MatrixXd arm_;  // [kg m] per scale factor of the mass
};

}  // namespace

extern const ResponseRow kFirstMoment;
const ResponseRow kFirstMoment{.name = "first_moment",
                               .words = "first moment about the root",
                               .unit = "kg m",
                               .linear = true,
                               .make = make_response<FirstMoment>};

}  // namespace flexmorph::mmc
