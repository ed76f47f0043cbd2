#include "cases/build.h"

#include <cmath>
#include <random>

#include "fem/elements/ancf_plate.h"

namespace flexmorph::cases {
namespace {

fem::FrameDrive drive_of(const Hub& hub, const TimeSpan& time) {
  fem::FrameMotion still;
  still.origin = hub.position;
  if (time.start != Start::hub_at_rest)
    return [hub, still](double t) {
      fem::FrameMotion f = still;
      f.angle = hub.angle + hub.angular_velocity * t;
      f.angle_rate = hub.angular_velocity;
      return f;
    };
  // ω(t) = ω s(t/T), s = 10u³ - 15u⁴ + 6u⁵: rate and acceleration start and end smoothly.
  return [hub, still, T = time.spin_up](double t) {
    fem::FrameMotion f = still;
    const double w = hub.angular_velocity, u = std::min(1.0, t / T);
    f.angle = hub.angle + w * T * std::pow(u, 4) * (2.5 - 3 * u + u * u) + w * std::max(0.0, t - T);
    f.angle_rate = w * std::pow(u, 3) * (10 - 15 * u + 6 * u * u);
    f.angle_acceleration = w / T * 30 * u * u * (1 - u) * (1 - u);
    return f;
  };
}

std::unique_ptr<fem::Element> elements_of(const Body& body, double end,
                                          const std::array<int, 2>& count) {
  const double longest = body.longest(end);
  std::vector<fem::MaterialLine> m, n;
  for (int i = 0; i <= count[0]; ++i)
    m.push_back({longest - body.length + body.length * i / count[0], {}});
  if (body.flow)
    m[0].drive = [longest, length = body.length, speed = body.flow->speed](double t) {
      return fem::Motion{longest - length - speed * t, -speed, 0};
    };
  for (int j = 0; j <= count[1]; ++j)
    n.push_back({-0.5 * body.width + body.width * j / count[1], {}});
  const auto shapes =
      body.shape == "h12" ? fem::AncfPlate::ShapeSet::h12 : fem::AncfPlate::ShapeSet::h16;
  return std::make_unique<fem::AncfPlate>(2, shapes, std::move(m), std::move(n));
}

fem::PlaneSection section_of(const Body& body) {
  return {body.thickness, body.youngs_modulus, body.poisson_ratio, body.density};
}

VectorXd gravity_of(const Scene& scene) {
  return scene.gravity ? VectorXd(*scene.gravity) : VectorXd();
}

}  // namespace

Mechanism build_mechanism(const Scene& scene, const MeshChoice& mesh) {
  Mechanism out;
  const VectorXd gravity = gravity_of(scene);
  for (const Body& body : scene.bodies) {
    const fem::PlaneSection section = section_of(body);
    std::vector<std::unique_ptr<fem::Term>> terms;
    for (const std::string& name : body.terms) terms.push_back(fem::make_term(name, section));
    if (gravity.size() > 0) terms.push_back(fem::make_gravity(section, gravity));
    for (const fem::AttachedMass& m : attached_masses(scene, body.name))
      terms.push_back(fem::make_point_mass(m.mass, m.material, gravity));
    const std::array<int, 2> count = mesh.elements.value_or(body.elements);
    out.model.add_body(body.name, elements_of(body, scene.time.end, count), section,
                       std::move(terms));
  }
  for (const Joint& joint : scene.joints) {
    const Body& body = scene.body(joint.body);
    const auto hub = std::find_if(scene.hubs.begin(), scene.hubs.end(),
                                  [&](const Hub& h) { return h.name == joint.to; });
    const fem::FrameDrive drive = drive_of(*hub, scene.time);
    out.model.add_joint(
        fem::make_weld(joint.body + "." + joint.edge, joint.body, joint.edge, drive, joint.mode));
    const double finer =
        mesh.elements ? static_cast<double>(body.elements[0]) / (*mesh.elements)[0] : 1;
    fem::Growth growth{joint.body, drive, 1, 0};
    if (body.flow) {
      growth.max_length = finer * body.flow->max_length;
      growth.min_length = finer * body.flow->min_length;
    }
    out.growths.push_back(growth);
  }
  out.motion.end = scene.time.end;
  out.motion.step = mesh.step.value_or(scene.time.step);
  out.motion.start =
      scene.time.start == Start::prestretched ? fem::Start::prestretched : fem::Start::rigid;
  out.motion.alpha.rho_inf = scene.time.rho_inf;
  out.motion.gravity = gravity;
  return out;
}

std::vector<fem::AttachedMass> attached_masses(const Scene& scene, const std::string& body) {
  std::vector<fem::AttachedMass> out;
  for (const PointMass& m : scene.point_masses)
    if (m.body == body) out.push_back({m.mass, Vec2(scene.body(body).longest(scene.time.end), 0)});
  return out;
}

namespace {

/// Moves every component at random: places and lengths by up to `jitter` of the half-length, angles
/// of a radian, half-thicknesses of themselves. The same seed gives the same start.
void shake(std::vector<Component>& components, double jitter, int seed) {
  if (jitter == 0) return;
  std::mt19937 engine(static_cast<unsigned>(seed));
  // Not std::uniform_real_distribution, which differs between standard libraries.
  const auto draw = [&] {
    return jitter * (2 * (static_cast<double>(engine()) / 4294967295.0) - 1);
  };
  for (Component& c : components) {
    const double size = c.half_length;
    c.center += size * Vec2(draw(), draw());
    c.half_length += size * draw();
    c.angle += draw();
    for (double* thickness : {&c.c1, &c.c2, &c.c3}) *thickness *= 1 + draw();
  }
}

fem::PlaneSection section_of_design(const Scene& scene, const BodyDesign& d) {
  if (!scene.domain) return section_of(scene.body(d.body));
  const Domain& domain = *scene.domain;
  return {domain.thickness, domain.youngs_modulus, domain.poisson_ratio, 0};
}

}  // namespace

std::vector<mmc::BodyProblem> build_problems(const Scene& scene) {
  std::vector<mmc::BodyProblem> out;
  for (const BodyDesign& d : scene.designs) {
    const Grid& g = d.grid;
    mmc::DesignScale scale;
    scale.half_length = d.half_length;
    scale.min_thickness = std::max(d.min_thickness, mmc::half_thickness_for(d.min_feature));
    scale.max_thickness = std::max({0.3 * g.height, 1.5 * scale.min_thickness, d.half_thickness});
    auto layout = d.start.empty()
                      ? crossing_layout(g.x0, g.y0, g.width, g.height, d.components[0],
                                        d.components[1], d.half_thickness, d.half_length)
                      : d.start;
    shake(layout, d.jitter, d.seed);
    std::vector<TdfSettings> stages;
    for (size_t i = 0; i < d.band.size(); ++i) stages.push_back(d.stage(i));
    out.push_back({d.body,
                   g,
                   section_of_design(scene, d),
                   mmc::Design(g, layout, scale),
                   d.solid,
                   d.empty,
                   stages,
                   d.goal,
                   d.stiffness_void,
                   d.mass_void,
                   scene.esl ? scene.esl->settings : mmc::ComplianceSettings{},
                   {},
                   {},
                   {},
                   d.drop_every,
                   d.refill,
                   d.min_feature});
    if (!scene.domain) continue;
    out.back().domain = scene.domain->polygon;
    if (!scene.domain->polygon.empty())
      out.back().outside = cells_outside(g, scene.domain->polygon);
    out.back().places = static_places(scene, g, out.back().outside);
  }
  return out;
}

std::vector<double> load_times(const Scene& scene) {
  std::vector<double> out;
  if (scene.esl)
    for (int i = 1; i <= scene.esl->count(scene.time.end); ++i) out.push_back(i * scene.esl->every);
  return out;
}

}  // namespace flexmorph::cases
