#include "geometry/components/tdf.h"

#include <cassert>
#include <cmath>
#include <string>

#include "geometry/components/component_tdf.h"

namespace flexmorph {

using namespace component_tdf_kernels;

namespace {

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

Heaviside heaviside(double phi, const TdfSettings& settings) {
  const double band = settings.band, alpha = settings.alpha, t = phi / band;
  if (t >= 1) return {1, 0, 0};
  if (t <= -1) return {alpha, 0, 0};
  const double t2 = t * t, middle = 0.5 * (1 + alpha);
  if (settings.kind == TdfSettings::Kind::paper) {
    const double scale = 0.75 * (1 - alpha);
    return {scale * (t - t * t2 / 3) + middle, scale * (1 - t2) / band,
            -2 * scale * t / (band * band)};
  }
  const double scale = (1 - alpha) / 16;
  return {scale * t * (15 - t2 * (10 - 3 * t2)) + middle, 15 * scale * (1 - t2) * (1 - t2) / band,
          -60 * scale * t * (1 - t2) / (band * band)};
}

double component_tdf(const Component& c, const TdfSettings& s, double X, double Y,
                     double* d_parameters) {
  assert(c.half_length > 0 && s.min_half_thickness > 0);
  const ComponentFrame frame(c, s.min_half_thickness);
  const double x = frame.x(X, Y), y = frame.y(X, Y);
  const Partials<double> d = s.kind == TdfSettings::Kind::paper
                                 ? paper_partials(frame.shape(), x, y)
                                 : distance_partials(frame.shape(), x, y);
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

UnionTdf::UnionTdf(const Grid& grid, TdfSettings settings) : grid_(grid), settings_(settings) {
  check(settings);
  for (VectorXd* v : {&phi_, &h_, &eroded_, &highest_, &sum_, &chain_, &chain_eroded_, &zero_}) {
    v->setZero(grid.n_nodes());
  }
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

void UnionTdf::Scratch::reserve_memory(std::size_t n) {
  if (x.size() >= n) return;
  for (std::vector<double>* v : {&x, &y, &seed}) v->resize(2 * n);
  node.resize(2 * n);
}

/// Computes φ_i of every component at the nodes in its range, and the highest φ_i of each node.
void UnionTdf::find_reach(std::span<const Component> components) {
  runs_.clear();
  ends_.clear();
  visits_.clear();
  highest_.setConstant(cut_);
  using Kind = TdfSettings::Kind;
  const auto at_points =
      settings_.kind == Kind::paper ? tdf_at_points<Kind::paper> : tdf_at_points<Kind::distance>;
  for (const Component& component : components) {
    const ComponentFrame frame(component, settings_.min_half_thickness);
    const std::size_t first_run = runs_.size(), first_visit = visits_.size();
    add_runs(frame);
    double* value = visits_.data() + first_visit;
    const int count = static_cast<int>(visits_.size() - first_visit);
    at_points(frame, count, scratch_.x.data(), scratch_.y.data(), value);
    for (std::size_t r = first_run; r < runs_.size(); value += runs_[r].count, ++r) {
      double* highest = highest_.data() + grid_.node(runs_[r].column, runs_[r].row);
      for (int k = 0; k < runs_[r].count; ++k) highest[k] = std::max(highest[k], value[k]);
    }
    ends_.push_back(runs_.size());
  }
}

/// Adds the nodes in the range of one component: their runs, the storage of their values, and their
/// local coordinates in the scratch buffers. All nodes of a component form one loop, which is long
/// enough for SIMD instructions.
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
    scratch_.reserve_memory(visits + static_cast<std::size_t>(count));
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

/// Computes φ as a smooth maximum from sums of terms relative to exp(λ highest).
void UnionTdf::join_smoothly() {
  const double lambda = settings_.sharpness;
  sum_.setZero();
  terms_.resize(visits_.size());
  double* visit = visits_.data();
  double* own = terms_.data();
  for (const Run& run : runs_) {
    const int first = grid_.node(run.column, run.row);
    for (int n = first; n < first + run.count; ++n, ++visit, ++own) {
      const Term term = smooth_term(lambda, *visit, cut_, highest_[n]);
      *own = term.value;
      *visit = term.slope;
      sum_[n] += term.value;
    }
  }
  for (int n = 0; n < grid_.n_nodes(); ++n) {
    const bool reached = highest_[n] > cut_ && sum_[n] > 0;
    phi_[n] = reached ? std::max(cut_, highest_[n] + std::log(sum_[n]) / lambda) : cut_;
  }
}

/// Computes φ as a maximum. The first highest component of a node has the weight 1, all others 0.
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
    const Heaviside h = heaviside(phi_[n], settings_);
    h_[n] = h.value;
    chain_[n] = h.slope == 0 ? 0.0 : h.slope / sum_[n];
    const Heaviside e = heaviside(phi_[n] - settings_.erosion, settings_);
    eroded_[n] = e.value;
    chain_eroded_[n] = e.slope == 0 ? 0.0 : e.slope / sum_[n];
  }
}

void UnionTdf::pull_back(const VectorXd& df_dh, const VectorXd& df_deroded, VectorXd& df_dp) const {
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
    int count = 0;  // nodes of this component with H' != 0 or E' != 0
    for (; r < ends_[c]; visit += runs_[r].count, ++r) {
      count = add_seeds(frame, runs_[r], visit, df_dh, df_deroded, count);
    }
    sum(frame, count, scratch_.x.data(), scratch_.y.data(), scratch_.seed.data(),
        df_dp.data() + kParameters * static_cast<Eigen::Index>(c));
  }
  if (!df_dp.allFinite())
    throw Error::numerical("tdf: the derivative of f with respect to H is not finite");
}

void UnionTdf::pull_back(const MatrixXd& df_dh, const MatrixXd& df_deroded, MatrixXd& df_dp) const {
  assert(evaluated_ && df_deroded.cols() == grid_.n_nodes());
  constexpr int kParameters = Component::kParameters;
  const Eigen::Index n_functions = df_deroded.rows();
  df_dp.resize(n_functions, kParameters * static_cast<Eigen::Index>(components_.size()));
  using Kind = TdfSettings::Kind;
  const auto fill =
      settings_.kind == Kind::paper ? fill_chain<Kind::paper> : fill_chain<Kind::distance>;
  Scratch& s = scratch_;
  s.node_seeds = df_deroded * chain_eroded_.asDiagonal();
  if (df_dh.size() > 0) s.node_seeds += df_dh * chain_.asDiagonal();
  const double* visit = visits_.data();
  std::size_t r = 0;
  for (std::size_t c = 0; c < components_.size(); ++c) {
    const ComponentFrame frame(components_[c], settings_.min_half_thickness);
    int count = 0;
    for (; r < ends_[c]; visit += runs_[r].count, ++r) {
      count = add_points(frame, runs_[r], visit, count);
    }
    if (s.seeds.cols() < count || s.seeds.rows() != n_functions)
      s.seeds.resize(n_functions, 2 * count);
    if (s.chain.size() < kParameters * count) s.chain.resize(kParameters, 2 * count);
    for (int k = 0; k < count; ++k)
      s.seeds.col(k) = s.node_seeds.col(s.node[static_cast<std::size_t>(k)]);
    fill(frame, count, s.x.data(), s.y.data(), s.seed.data(), s.chain.data());
    df_dp.middleCols(kParameters * static_cast<Eigen::Index>(c), kParameters).noalias() =
        s.seeds.leftCols(count) * Eigen::Map<const MatrixXd>(s.chain.data(), count, kParameters);
  }
  if (!df_dp.allFinite())
    throw Error::numerical("tdf: a derivative with respect to H is not finite");
}

/// Appends the local coordinates, weights dφ/dφ_i and indices of the nodes of a run at which
/// density() or eroded() changes with φ.
int UnionTdf::add_points(const ComponentFrame& frame, const Run& run, const double* visit,
                         int count) const {
  scratch_.reserve_memory(static_cast<std::size_t>(count + run.count));
  const double X = grid_.x0 + run.column * grid_.dx();
  const int first = grid_.node(run.column, run.row);
  for (int k = 0; k < run.count; ++k) {
    const int n = first + k;
    if (visit[k] == 0 || (chain_[n] == 0 && chain_eroded_[n] == 0)) continue;
    const double Y = grid_.y0 + (run.row + k) * grid_.dy();
    const auto at = static_cast<std::size_t>(count++);
    scratch_.x[at] = frame.x(X, Y);
    scratch_.y[at] = frame.y(X, Y);
    scratch_.seed[at] = visit[k];
    scratch_.node[at] = n;
  }
  return count;
}

/// Returns φ of the union at a node of a run without the component of the run.
double UnionTdf::taken_out(const Run& run, int k, std::size_t visit) const {
  const int n = grid_.node(run.column, run.row) + k;
  if (visits_[visit] == 0) return phi_[n];
  // the second highest value is not stored
  if (settings_.kind == TdfSettings::Kind::paper) return cut_;
  const double rest = sum_[n] - terms_[visit];
  // Below this bound the difference is only round-off of the sum, whose largest term was
  // subtracted.
  if (!(rest > 1e-12 * sum_[n])) return cut_;
  return std::max(cut_, highest_[n] + std::log(rest) / settings_.sharpness);
}

std::vector<double> UnionTdf::influence(std::span<const signed char> counts) const {
  assert(evaluated_ && counts.size() == static_cast<std::size_t>(grid_.n_nodes()));
  std::vector<double> out(components_.size(), 0.0);
  std::size_t r = 0, visit = 0;
  for (std::size_t c = 0; c < components_.size(); ++c) {
    for (; r < ends_[c]; visit += static_cast<std::size_t>(runs_[r].count), ++r) {
      const int first = grid_.node(runs_[r].column, runs_[r].row);
      for (int k = 0; k < runs_[r].count; ++k) {
        if (counts[static_cast<std::size_t>(first + k)] == 0) continue;
        const double phi = taken_out(runs_[r], k, visit + static_cast<std::size_t>(k));
        const auto change = [&](double depth, double now) {
          return now - heaviside(phi - depth, settings_).value;
        };
        out[c] = std::max(
            {out[c], change(0, h_[first + k]), change(settings_.erosion, eroded_[first + k])});
      }
    }
  }
  return out;
}

/// Appends the local coordinates and df/dφ_i of the nodes of a run at which density() or eroded()
/// changes with φ.
int UnionTdf::add_seeds(const ComponentFrame& frame, const Run& run, const double* visit,
                        const VectorXd& df_dh, const VectorXd& df_deroded, int count) const {
  scratch_.reserve_memory(static_cast<std::size_t>(count + run.count));
  const double X = grid_.x0 + run.column * grid_.dx();
  const int first = grid_.node(run.column, run.row);
  for (int k = 0; k < run.count; ++k) {
    const int n = first + k;
    const double Y = grid_.y0 + (run.row + k) * grid_.dy();
    const auto at = static_cast<std::size_t>(count);
    scratch_.x[at] = frame.x(X, Y);
    scratch_.y[at] = frame.y(X, Y);
    scratch_.seed[at] = (df_dh[n] * chain_[n] + df_deroded[n] * chain_eroded_[n]) * visit[k];
    count += (chain_[n] != 0 || chain_eroded_[n] != 0) && visit[k] != 0 ? 1 : 0;
  }
  return count;
}

}  // namespace flexmorph
