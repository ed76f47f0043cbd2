#include "cases/results/motion_columns.h"

#include <algorithm>
#include <cmath>

namespace flexmorph::cases {
namespace {

/// Describes a column per coordinate of every observed point.
/// @param letter  letter in the column names: "u" for displacements, empty for positions
void describe_points(const Scene& scene, const std::string& letter, const std::string& what,
                     std::vector<ColumnInfo>& out) {
  for (const Observe& o : scene.observed)
    for (int c = 0; c < scene.body(o.body).dim(); ++c) {
      const std::string axis(1, "xyz"[c]);
      out.push_back({o.body + "." + o.name + "_" + letter + axis, "m",
                     what + " of the observed point along " + axis, ColumnGroup::observed});
    }
}

bool has_tip(const Scene& scene, const fem::MovingRoot& growth) {
  return !scene.body(growth.body).in_space() && growth.line == 0;
}

/// Returns the energy of a step that belongs to the column of a term.
double fem::MotionStep::*energy_of_term(const std::string& column) {
  if (column == "energy.dissipated") return &fem::MotionStep::dissipated;
  throw Error::input("column '" + column + "': a time step computes no energy for this column");
}

}  // namespace

double tip_deflection(const fem::Model& model, const fem::MovingRoot& growth, const fem::State& x) {
  const fem::Body& body = model.body(growth.body);
  const fem::LineGrid& mesh = fem::grid_of(body);
  const fem::FrameMotion hub = growth.hub.at(model, x);
  const Vec2 tip = fem::point_motion(body, x, {mesh.line_m(mesh.n_m()).value, 0}).position;
  return Vec2(-std::sin(hub.angle), std::cos(hub.angle)).dot(tip - hub.origin);
}

double deflection_across(const fem::Model& model, const DeflectingPoint& at, const fem::State& x) {
  const fem::Body& body = model.body(at.point->body);
  Vec2 origin, material(0, 0);
  double angle;
  if (at.growth) {
    const fem::FrameMotion hub = at.growth->hub.at(model, x);
    origin = hub.origin, angle = hub.angle;
  } else {
    const auto direction = [](const Vec2& d) { return std::atan2(d.y(), d.x()); };
    material = at.line[0];
    origin = fem::point_position(body, x, at.line[0]).head<2>();
    const Vec2 end = fem::point_position(body, x, at.line[1]).head<2>();
    angle = direction(end - origin) - direction(at.line[1] - at.line[0]);
  }
  const Vec2 p = fem::point_position(body, x, at.point->point).head<2>();
  return Vec2(-std::sin(angle), std::cos(angle)).dot(p - origin) -
         (at.point->point.y() - material.y());
}

std::vector<std::string> columns_of_terms(const Scene& scene) {
  std::vector<std::string> out;
  for (const Body& body : scene.bodies)
    for (const std::string& term : body.terms)
      for (const std::string& column : fem::term_row(term).columns)
        if (std::find(out.begin(), out.end(), column) == out.end()) out.push_back(column);
  return out;
}

std::vector<ColumnInfo> path_columns(const Scene& scene) {
  std::vector<ColumnInfo> out = {
      {"step", "-", "number of the equilibrium, from 0", ColumnGroup::abscissa},
      {kFactorColumn, "-", "factor that multiplies the loads", ColumnGroup::abscissa}};
  describe_points(scene, "u", "displacement", out);
  const std::vector<ColumnInfo> measured = BodyMeasures::columns(scene);
  out.insert(out.end(), measured.begin(), measured.end());
  const MechanismColumns mechanism(scene);
  out.insert(out.end(), mechanism.columns().begin(), mechanism.columns().end());
  out.push_back({kStrainColumn, "J", "strain energy of all bodies", ColumnGroup::energy});
  out.push_back({"iterations", "-", "iterations of Newton's method", ColumnGroup::solver});
  return out;
}

MotionColumns::MotionColumns(const Scene& scene, std::span<const fem::MovingRoot> moving_roots,
                             bool balance)
    : scene_(scene), balance_(balance), mechanism_(scene) {
  describe(kTimeColumn, "s", "time", ColumnGroup::abscissa);
  describe_bodies(moving_roots);
  describe_points(scene, "", "position", columns_);
  describe_deflecting_points(moving_roots);
  for (const Body& body : scene.bodies)
    for (const BodyLine& line : body.lines)
      if (line.free)
        describe(body.name + ".line_" + std::to_string(line.index), "m",
                 "material coordinate of a free mesh line", ColumnGroup::observed);
  const std::vector<ColumnInfo> measured = BodyMeasures::columns(scene);
  columns_.insert(columns_.end(), measured.begin(), measured.end());
  columns_.insert(columns_.end(), mechanism_.columns().begin(), mechanism_.columns().end());
  describe_energies();
}

void MotionColumns::describe(const std::string& name, const char* unit, std::string meaning,
                             ColumnGroup group) {
  columns_.push_back({name, unit, std::move(meaning), group});
}

void MotionColumns::describe_bodies(std::span<const fem::MovingRoot> moving_roots) {
  for (const fem::MovingRoot& growth : moving_roots) {
    const Body& body = scene_.body(growth.body);
    if (has_tip(scene_, growth)) deflecting_.push_back(&growth);
    // A free root already has a column for its material coordinate, so it needs no length.
    if ((has_tip(scene_, growth) || body.flow) && !body.has_eulerian_lines())
      flowing_.push_back(&body);
  }
  for (const fem::MovingRoot* growth : deflecting_)
    describe(growth->body + kDeflectionEnding, "m",
             "deflection of the middle of the free end, perpendicular to the hub's axis",
             ColumnGroup::deflection);
  for (const Body* body : flowing_)
    describe(body->name + ".length", "m", "length of the body outside of its hub or sleeve",
             ColumnGroup::length);
}

void MotionColumns::describe_deflecting_points(std::span<const fem::MovingRoot> moving_roots) {
  for (const Observe& o : scene_.observed)
    for (const BodyDesign& design : scene_.designs) {
      const Body& body = scene_.body(o.body);
      if (design.body != o.body || body.in_space()) continue;
      DeflectingPoint at{&o, nullptr, {Vec2(0, body.low()), Vec2(0, body.low() + body.width)}};
      for (const fem::MovingRoot& growth : moving_roots)
        if (growth.body == o.body) at.growth = &growth;
      if (design.link) at.line = design.link->pins;
      points_.push_back(at);
      describe(o.body + "." + o.name + kAcrossEnding, "m",
               "displacement of the observed point perpendicular to the undeformed body",
               ColumnGroup::across);
    }
}

void MotionColumns::describe_energies() {
  describe(kKineticColumn, "J", "kinetic energy of the model", ColumnGroup::energy);
  describe(kStrainColumn, "J", "strain energy of the model", ColumnGroup::energy);
  describe(kPotentialColumn, "J", "potential energy of weight and applied forces",
           ColumnGroup::energy);
  describe(kEnergyErrorColumn, "J",
           "energy error: energy minus initial energy minus work of all powers",
           ColumnGroup::energy);
  // Springs and other bodies would hide what the designs change.
  if (!scene_.springs.empty() || scene_.bodies.size() > scene_.designs.size())
    for (const BodyDesign& design : scene_.designs) designed_.push_back(design.body);
  if (!designed_.empty())
    describe(kDesignedColumn, "J", "strain energy of the designed bodies", ColumnGroup::energy);
  if (!balance_) return;
  for (const std::string& name : columns_of_terms(scene_)) {
    describe(name, "J", "energy dissipated by the terms of the bodies", ColumnGroup::term);
    terms_.push_back(energy_of_term(name));
  }
  if (!scene_.is_mechanism()) return;
  describe("power.drive", "W", "power of all drives", ColumnGroup::power);
  describe("power.feed", "W", "power that moves the material through the mesh", ColumnGroup::power);
  describe("power.inflow", "W", "energy per time that entering material carries",
           ColumnGroup::power);
  if (scene_.has_heat())
    describe("power.heat", "W", "power of the prescribed temperatures", ColumnGroup::power);
}

std::span<const double> MotionColumns::row(const fem::MotionStep& step) {
  row_.clear();
  row_.push_back(step.x.t);
  append_bodies(step);
  if (!scene_.measures.empty()) {
    if (!measures_) {
      measures_.emplace(scene_, step.model, undeformed_);
      first_ = step.x;
    }
    measures_->append(step.model, step.x, 1, row_);
  }
  mechanism_.append(step.model, step.x, row_);
  append_energies(step);
  return row_;
}

void MotionColumns::append_bodies(const fem::MotionStep& step) {
  for (const fem::MovingRoot* growth : deflecting_)
    row_.push_back(tip_deflection(step.model, *growth, step.x));
  for (const Body* body : flowing_) row_.push_back(body->length_at(step.x.t));
  for (const Observe& o : scene_.observed) {
    const Vec3 r = fem::point_position(step.model.body(o.body), step.x, o.point);
    for (int c = 0; c < scene_.body(o.body).dim(); ++c) row_.push_back(r[c]);
  }
  for (const DeflectingPoint& at : points_)
    row_.push_back(deflection_across(step.model, at, step.x));
  for (const fem::Body& body : step.model.bodies())
    for (int k = 0; k < body.element->n_scalars(); ++k)
      row_.push_back(step.x.q[body.first_scalar() + k]);
}

void MotionColumns::append_energies(const fem::MotionStep& step) {
  row_.insert(row_.end(), {step.energies.kinetic, step.energies.strain, step.energies.potential,
                           step.energy_error});
  if (!designed_.empty()) {
    double strain = 0;
    for (const std::string& body : designed_)
      strain += step.model.energies(step.x, step.model.body(body)).strain;
    row_.push_back(strain);
  }
  if (!balance_) return;
  for (const auto energy : terms_) row_.push_back(step.*energy);
  if (!scene_.is_mechanism()) return;
  row_.insert(row_.end(), {step.powers.drive, step.powers.feed, step.powers.inflow});
  if (scene_.has_heat()) row_.push_back(step.powers.heat);
}

void MotionColumns::archive(Archive& memory, fem::Workspace& model) {
  mechanism_.archive(memory);
  if (scene_.measures.empty()) return;
  memory(first_);
  if (!memory.is_restoring()) return;
  model.prepare(first_);
  measures_.emplace(scene_, model, undeformed_);
}

}  // namespace flexmorph::cases
