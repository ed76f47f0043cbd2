#include "geometry/tdf.h"

#include <cassert>
#include <cmath>
#include <string>

#include "geometry/component_frame.h"

namespace flexmorph {

namespace {

/// s = (u⁶ + v⁶)^(1/6), at least 1e-50: the center needs no case of its own.
///
/// With the larger square taken out, w = 1 + r³ lies in [1, 2], and s² = larger w (w^(-1/6))⁴.
/// The inverse root starts from a parabola (right to 1.1e-3) and takes three Newton steps
/// t <- t (7 - w t⁶) / 6 to full precision. Unlike pow and cbrt it has no branches, so that loops
/// over it run in vector registers.
inline double superellipse_radius(double u, double v) {
  const double u2 = u * u, v2 = v * v;
  const double larger = std::max(std::max(u2, v2), 1e-100);
  const double r = std::min(u2, v2) / larger;
  const double z = r * r * r, w = 1 + z;
  double t = 1 - z * (0.15337 - 0.04444 * z);
  for (int step = 0; step < 3; ++step) {
    const double t3 = t * t * t;
    t *= (7 - w * t3 * t3) * (1.0 / 6);
  }
  const double t2 = t * t;
  return std::sqrt(larger * w) * t2;
}

inline double fifth_power(double t) { return t * t * t * t * t; }

inline double sixth_power(double t) {
  const double t3 = t * t * t;
  return t3 * t3;
}

/// P = (1 - s) R of a superellipse of constant g, from u = x/L, v = y/g, and what its derivatives
/// need:   R = w/|∇s| + (1 - w) g,   ∇s = (A/L, B/g),   A = (u/s)⁵,   B = (v/s)⁵,
/// w = min(s, 1)². On the outline and outside this is the first-order distance; |∇s| depends on
/// the direction from the center only, so that w keeps the slope bounded there.
struct FirstOrderDistance {
  double s, a, b, A, B, per_slope, w, R, P;

  FirstOrderDistance(double u, double v, double per_L, double per_g, double g)
      : s(superellipse_radius(u, v)) {
    const double per_s = 1 / s;
    a = u * per_s;
    b = v * per_s;
    A = fifth_power(a);
    B = fifth_power(b);
    const double along = A * per_L, across = B * per_g;
    // The floor acts at the very center only, where a = b = 0.
    per_slope = 1 / std::sqrt(std::max(along * along + across * across, 1e-6 * per_L * per_L));
    const double inside = std::min(s, 1.0);
    w = inside * inside;
    R = w * per_slope + (1 - w) * g;
    P = (1 - s) * R;
  }
};

/// Inside, P/(1 + (P/g)⁸)^(1/8): no point is further from the outline than the half-thickness.
inline double capped(double P, double g) {
  const double r = std::max(P, 0.0) / g, r2 = r * r, r4 = r2 * r2;
  return P / std::sqrt(std::sqrt(std::sqrt(1 + r4 * r4)));
}

inline double distance_tdf(const ComponentFrame& frame, double x, double y) {
  const double g = frame.half_thickness(x), per_g = 1 / g;
  const FirstOrderDistance f(x * frame.per_length(), y * per_g, frame.per_length(), per_g, g);
  return capped(f.P, g);
}

inline double paper_tdf(const ComponentFrame& frame, double x, double y) {
  return 1 - sixth_power(x * frame.per_length()) - sixth_power(y / frame.half_thickness(x));
}

/// φ of one component and its partial derivatives; those by g are already times dg.
struct Partials {
  double phi;
  double x, y;           // by the local coordinates
  double L, c1, c2, c3;  // at fixed local coordinates
};

/// φ(u, v, g, L) with u = x/L, v = y/g(x):  dφ = φ_u du + φ_v dv + φ_g dg + φ_L dL,
/// du = dx/L - u dL/L,  dv = (dy - v dg)/g.
struct ByShape {
  double u, v, g, L;
};
inline Partials chain(const ComponentFrame& frame, const Profile& profile, double u, double v,
                      double phi, const ByShape& d) {
  const double by_g = d.g - d.v * v / profile.g;
  const double per_L = frame.per_length();
  return {phi,
          d.u * per_L + by_g * profile.dg_dx,
          d.v / profile.g,
          d.L - d.u * u * per_L + by_g * profile.dg_dp[0],
          by_g * profile.dg_dp[1],
          by_g * profile.dg_dp[2],
          by_g * profile.dg_dp[3]};
}

/// φ = P q^(-1/8), q = 1 + (P/g)⁸ inside and 1 outside:  φ_P = q^(-9/8),  φ_g = (P/g)⁹ φ_P.
/// With D = |∇s|, s_u = A, s_v = B and
/// A_u = 5 a⁴ b⁶/s,  B_v = 5 b⁴ a⁶/s,  A_v = B_u = -5 a⁵ b⁵/s:
/// P_u = -A R + (1 - s) (w_u (1/D - g) - w D_u/D²),  P_v likewise.
inline Partials distance_partials(const ComponentFrame& frame, double x, double y) {
  const Profile profile = frame.profile(x);
  const double g = profile.g, per_L = frame.per_length(), per_g = 1 / g;
  const double u = x * per_L, v = y * per_g;
  const FirstOrderDistance f(u, v, per_L, per_g, g);
  const double a2 = f.a * f.a, b2 = f.b * f.b, a4 = a2 * a2, b4 = b2 * b2, five = 5 / f.s;
  const double A_u = five * a4 * b4 * b2, B_v = five * b4 * a4 * a2, cross = -five * f.A * f.B;
  const double wA = f.A * per_L * per_L, wB = f.B * per_g * per_g, depth = 1 - f.s;
  const double cube = f.w * f.per_slope * f.per_slope * f.per_slope;
  const double by_w = depth * (f.s < 1 ? 2 * f.s : 0.0) * (f.per_slope - g);
  const double P_u = f.A * (by_w - f.R) - depth * cube * (wA * A_u + wB * cross);
  const double P_v = f.B * (by_w - f.R) - depth * cube * (wA * cross + wB * B_v);
  const double P_L = depth * cube * wA * f.A * per_L;
  const double P_g = depth * (cube * wB * f.B * per_g + 1 - f.w);

  const double r = std::max(f.P, 0.0) * per_g, r2 = r * r, r4 = r2 * r2, q = 1 + r4 * r4;
  const double root = 1 / std::sqrt(std::sqrt(std::sqrt(q))), by_P = root / q;
  return chain(frame, profile, u, v, f.P * root,
               {P_u * by_P, P_v * by_P, P_g * by_P + r4 * r4 * r * by_P, P_L * by_P});
}

/// φ = 1 - u⁶ - v⁶.
inline Partials paper_partials(const ComponentFrame& frame, double x, double y) {
  const Profile profile = frame.profile(x);
  const double u = x * frame.per_length(), v = y / profile.g;
  return chain(frame, profile, u, v, 1 - sixth_power(u) - sixth_power(v),
               {-6 * fifth_power(u), -6 * fifth_power(v), 0.0, 0.0});
}

template <TdfSettings::Kind kind>
Partials partials(const ComponentFrame& frame, double x, double y) {
  return kind == TdfSettings::Kind::paper ? paper_partials(frame, x, y)
                                          : distance_partials(frame, x, y);
}

void tdf_at_points(const ComponentFrame& frame, TdfSettings::Kind kind, int count, const double* x,
                   const double* y, double* phi) {
  if (kind == TdfSettings::Kind::paper) {
#pragma omp simd
    for (int k = 0; k < count; ++k) phi[k] = paper_tdf(frame, x[k], y[k]);
  } else {
#pragma omp simd
    for (int k = 0; k < count; ++k) phi[k] = distance_tdf(frame, x[k], y[k]);
  }
}

/// Σ_k seed_k dφ(x_k, y_k)/dp for the seven parameters p.
template <TdfSettings::Kind kind>
void sum_chain(const ComponentFrame& frame, int count, const double* px, const double* py,
               const double* seed, double* out) {
  double by_x = 0, by_y = 0, by_angle = 0, by_L = 0, by_c1 = 0, by_c2 = 0, by_c3 = 0;
#pragma omp simd reduction(+ : by_x, by_y, by_angle, by_L, by_c1, by_c2, by_c3)
  for (int k = 0; k < count; ++k) {
    const double x = px[k], y = py[k], f = seed[k];
    const Partials d = partials<kind>(frame, x, y);
    by_x += f * d.x;
    by_y += f * d.y;
    by_angle += f * (d.x * y - d.y * x);
    by_L += f * d.L;
    by_c1 += f * d.c1;
    by_c2 += f * d.c2;
    by_c3 += f * d.c3;
  }
  out[0] = frame.sine() * by_y - frame.cosine() * by_x;
  out[1] = -frame.sine() * by_x - frame.cosine() * by_y;
  out[2] = by_L;
  out[3] = by_angle;
  out[4] = by_c1;
  out[5] = by_c2;
  out[6] = by_c3;
}

/// Rectangle of the component's frame that holds every point with φ > cut (cut < 0).
///
/// distance: s < 1 + |cut| |∇s| there. In the direction with u/s = a, v/s = b the point is at
/// x = a s L, y = b s g, so that |x| < a L + |cut| a √(A² + (B L/g)²) and
/// |y| < b g + |cut| b √((A g/L)² + B²): largest over all directions, x with the thinner tip's g
/// (beyond a tip g is the end value), y with the largest g.
/// paper: (x/L)⁶ and (y/g)⁶ are below 1 + |cut|.
Box reach(const ComponentFrame& frame, TdfSettings::Kind kind, double cut) {
  const double L = frame.half_length(), top = frame.largest_half_thickness();
  constexpr double kRoundOff = 1 + 1e-9;
  if (kind == TdfSettings::Kind::paper) {
    const double grown = std::sqrt(std::cbrt(1 - cut)) * kRoundOff;
    return {{-L * grown, -top * grown}, {L * grown, top * grown}};
  }
  const double thin = std::min(frame.half_thickness(-L), frame.half_thickness(L));
  double along = 0, across = 0;
  constexpr int kDirections = 64;
  for (int k = 0; k <= kDirections; ++k) {
    const double a6 = static_cast<double>(k) / kDirections;
    const double a = std::sqrt(std::cbrt(a6)), b = std::sqrt(std::cbrt(1 - a6));
    const double A = fifth_power(a), B = fifth_power(b);
    along = std::max(along, a * (L - cut * std::hypot(A, B * L / thin)));
    across = std::max(across, b * (top - cut * std::hypot(A * top / L, B)));
  }
  constexpr double kBetween = 1.01;  // between two sampled directions
  return {{-along * kBetween, -across * kBetween}, {along * kBetween, across * kBetween}};
}

void check(const TdfSettings& s) {
  const auto require = [](bool holds, const char* name, double value, const char* wanted) {
    if (holds) return;
    throw Error::input("tdf: " + std::string(name) + " = " + std::to_string(value) + ": " + wanted);
  };
  require(s.band > 0 && std::isfinite(s.band), "band", s.band, "a band is positive");
  require(s.sharpness > 0 && std::isfinite(s.sharpness), "sharpness", s.sharpness,
          "a sharpness is positive [1/m]");
  require(s.erosion >= 0 && std::isfinite(s.erosion), "erosion", s.erosion,
          "an erosion is not negative");
  require(s.alpha >= 0 && s.alpha < 1, "alpha", s.alpha, "0 <= alpha < 1");
  require(s.min_half_thickness > 0 && std::isfinite(s.min_half_thickness), "min_half_thickness",
          s.min_half_thickness, "a thickness is positive [m]");
}

void check(std::span<const Component> components) {
  for (std::size_t c = 0; c < components.size(); ++c) {
    bool sound = components[c].half_length > 0;
    for (const double p : components[c].parameters()) sound = sound && std::isfinite(p);
    if (!sound) {
      throw Error::numerical("tdf: component " + std::to_string(c) +
                             ": a parameter is not finite, or half_length = " +
                             std::to_string(components[c].half_length) + " is not positive");
    }
  }
}

}  // namespace

Heaviside heaviside(double phi, double band, double alpha) {
  const double t = phi / band;
  if (t >= 1) return {1, 0};
  if (t <= -1) return {alpha, 0};
  const double scale = 0.75 * (1 - alpha);
  return {scale * (t - t * t * t / 3) + 0.5 * (1 + alpha), scale * (1 - t * t) / band};
}

double component_tdf(const Component& c, const TdfSettings& s, double X, double Y,
                     double* d_parameters) {
  assert(c.half_length > 0 && s.min_half_thickness > 0);
  const ComponentFrame frame(c, s.min_half_thickness);
  const double x = frame.x(X, Y), y = frame.y(X, Y);
  const Partials d = s.kind == TdfSettings::Kind::paper ? paper_partials(frame, x, y)
                                                        : distance_partials(frame, x, y);
  if (d_parameters != nullptr) {
    d_parameters[0] = frame.sine() * d.y - frame.cosine() * d.x;
    d_parameters[1] = -frame.sine() * d.x - frame.cosine() * d.y;
    d_parameters[2] = d.L;
    d_parameters[3] = d.x * y - d.y * x;
    d_parameters[4] = d.c1;
    d_parameters[5] = d.c2;
    d_parameters[6] = d.c3;
  }
  return d.phi;
}

UnionTdf::UnionTdf(const Grid& grid, TdfSettings settings) : grid_(grid) {
  set_settings(settings);
  for (VectorXd* v : {&phi_, &h_, &eroded_, &highest_, &at_cut_, &sum_, &chain_, &chain_eroded_,
                      &zero_}) {
    v->setZero(grid.n_nodes());
  }
}

void UnionTdf::set_settings(const TdfSettings& s) {
  check(s);
  settings_ = s;
  evaluated_ = false;
}

void UnionTdf::evaluate(std::span<const Component> components) {
  check(components);
  components_.assign(components.begin(), components.end());
  const bool paper = settings_.kind == TdfSettings::Kind::paper;
  cut_ = -settings_.band - (paper ? 1.0 : 10 / settings_.sharpness);
  find_reach(components);
  if (paper) {
    join_by_maximum();
  } else {
    join_smoothly();
  }
  fill_density();
  evaluated_ = true;
}

void UnionTdf::Scratch::make_room(std::size_t n) {
  if (x.size() >= n) return;
  for (std::vector<double>* v : {&x, &y, &seed}) v->resize(2 * n);
}

/// φ_i of every component at the nodes it may reach, and the highest of each node.
void UnionTdf::find_reach(std::span<const Component> components) {
  runs_.clear();
  ends_.clear();
  visits_.clear();
  highest_.setConstant(cut_);
  for (const Component& component : components) {
    const ComponentFrame frame(component, settings_.min_half_thickness);
    const std::size_t first_run = runs_.size(), first_visit = visits_.size();
    add_runs(frame);
    double* value = visits_.data() + first_visit;
    const int count = static_cast<int>(visits_.size() - first_visit);
    tdf_at_points(frame, settings_.kind, count, scratch_.x.data(), scratch_.y.data(), value);
    for (std::size_t r = first_run; r < runs_.size(); value += runs_[r].count, ++r) {
      double* highest = highest_.data() + grid_.node(runs_[r].column, runs_[r].row);
      for (int k = 0; k < runs_[r].count; ++k) highest[k] = std::max(highest[k], value[k]);
    }
    ends_.push_back(runs_.size());
  }
}

/// The nodes one component may reach: their runs, room for their visits, and their local
/// coordinates in the scratch. All together make one loop long enough for vector registers.
void UnionTdf::add_runs(const ComponentFrame& frame) {
  const Box local = reach(frame, settings_.kind, cut_), box = frame.enclosing(local);
  const IndexRange columns =
      indices_in({box.lower.x(), box.upper.x()}, grid_.x0, grid_.dx(), grid_.nx + 1);
  const double y0 = grid_.y0, dy = grid_.dy();
  std::size_t visits = 0;
  for (int i = columns.first; i < columns.end; ++i) {
    const double X = grid_.x0 + i * grid_.dx();
    const IndexRange rows = indices_in(frame.column(X, local), y0, dy, grid_.ny + 1);
    const int count = rows.end - rows.first;
    if (count == 0) continue;
    runs_.push_back({i, rows.first, count});
    scratch_.make_room(visits + static_cast<std::size_t>(count));
    double* x = scratch_.x.data() + visits;
    double* y = scratch_.y.data() + visits;
    for (int k = 0; k < count; ++k) {
      const double Y = y0 + (rows.first + k) * dy;
      x[k] = frame.x(X, Y);
      y[k] = frame.y(X, Y);
    }
    visits += static_cast<std::size_t>(count);
  }
  visits_.resize(visits_.size() + visits);
}

/// Sums of exp(λ (φ_i - highest)), each less its value at the cut; at least one term is 1.
void UnionTdf::join_smoothly() {
  const double lambda = settings_.sharpness;
  for (int n = 0; n < grid_.n_nodes(); ++n) at_cut_[n] = std::exp(lambda * (cut_ - highest_[n]));
  sum_.setZero();
  double* visit = visits_.data();
  for (const Run& run : runs_) {
    const int first = grid_.node(run.column, run.row);
    for (int n = first; n < first + run.count; ++n, ++visit) {
      const bool reached = *visit > cut_;
      *visit = reached ? std::exp(lambda * (*visit - highest_[n])) : 0.0;
      if (reached) sum_[n] += *visit - at_cut_[n];
    }
  }
  for (int n = 0; n < grid_.n_nodes(); ++n) {
    const bool reached = highest_[n] > cut_ && sum_[n] > 0;
    phi_[n] = reached ? std::max(cut_, highest_[n] + std::log(sum_[n]) / lambda) : cut_;
  }
}

/// The first highest component of a node has weight 1, the others 0.
void UnionTdf::join_by_maximum() {
  sum_.setZero();
  double* visit = visits_.data();
  for (const Run& run : runs_) {
    const int first = grid_.node(run.column, run.row);
    for (int n = first; n < first + run.count; ++n, ++visit) {
      const bool wins = sum_[n] == 0 && *visit == highest_[n];
      *visit = wins ? 1.0 : 0.0;
      if (wins) sum_[n] = 1;
    }
  }
  phi_ = highest_;
}

void UnionTdf::fill_density() {
  for (int n = 0; n < grid_.n_nodes(); ++n) {
    const Heaviside h = heaviside(phi_[n], settings_.band, settings_.alpha);
    h_[n] = h.value;
    chain_[n] = h.slope == 0 ? 0.0 : h.slope / sum_[n];
    const Heaviside e = heaviside(phi_[n] - settings_.erosion, settings_.band, settings_.alpha);
    eroded_[n] = e.value;
    chain_eroded_[n] = e.slope == 0 ? 0.0 : e.slope / sum_[n];
  }
}

void UnionTdf::pull_back(const VectorXd& df_dh, const VectorXd& df_deroded,
                         VectorXd& df_dp) const {
  assert(evaluated_ && df_dh.size() == grid_.n_nodes() && df_deroded.size() == grid_.n_nodes());
  constexpr int kParameters = Component::kParameters;
  df_dp.resize(kParameters * static_cast<Eigen::Index>(components_.size()));
  using Kind = TdfSettings::Kind;
  const auto sum =
      settings_.kind == Kind::paper ? sum_chain<Kind::paper> : sum_chain<Kind::distance>;
  const double* visit = visits_.data();
  std::size_t r = 0;
  for (std::size_t c = 0; c < components_.size(); ++c) {
    const ComponentFrame frame(components_[c], settings_.min_half_thickness);
    int count = 0;  // nodes of this component with H' != 0
    for (; r < ends_[c]; visit += runs_[r].count, ++r) {
      count = add_seeds(frame, runs_[r], visit, df_dh, df_deroded, count);
    }
    sum(frame, count, scratch_.x.data(), scratch_.y.data(), scratch_.seed.data(),
        df_dp.data() + kParameters * static_cast<Eigen::Index>(c));
  }
  if (!df_dp.allFinite()) throw Error::numerical("tdf: the derivative of f by H is not finite");
}

/// Appends local coordinates and df/dφ_i of those nodes of a run that need the chain rule.
int UnionTdf::add_seeds(const ComponentFrame& frame, const Run& run, const double* visit,
                        const VectorXd& df_dh, const VectorXd& df_deroded,
                        int count) const {
  scratch_.make_room(static_cast<std::size_t>(count + run.count));
  const double X = grid_.x0 + run.column * grid_.dx();
  const int first = grid_.node(run.column, run.row);
  for (int k = 0; k < run.count; ++k) {
    const int n = first + k;
    const double Y = grid_.y0 + (run.row + k) * grid_.dy();
    const auto at = static_cast<std::size_t>(count);
    scratch_.x[at] = frame.x(X, Y);
    scratch_.y[at] = frame.y(X, Y);
    scratch_.seed[at] =
        (df_dh[n] * chain_[n] + df_deroded[n] * chain_eroded_[n]) * visit[k];
    count += (chain_[n] != 0 || chain_eroded_[n] != 0) && visit[k] != 0 ? 1 : 0;
  }
  return count;
}

}  // namespace flexmorph
