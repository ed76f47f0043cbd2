#include "cases/stability/judge.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>

#include "cases/check/ready.h"
#include "cases/run/run.h"
#include "cases/study/study.h"
#include "io/files.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

using io::to_text;
using nlohmann::json;

constexpr double kResolved = 0.3;  // h ω: twenty steps to a period

std::string percent(double share) { return to_text(100 * share, 2) + " %"; }

std::optional<double> number(const json& object, const char* key) {
  if (!object.is_object() || !object.contains(key) || !object[key].is_number()) return {};
  return object[key].get<double>();
}

/// Largest of the positive defects and of the energies in motion.csv.
void read_energies(const std::string& folder, Figures& out, double& kinetic) {
  const std::string path = folder + "/motion.csv";
  if (text_of(path).empty()) return;
  const io::CsvTable table = io::read_csv(path);
  const std::vector<double> t = table.numbers("energy.kinetic"), u = table.numbers("energy.strain"),
                            v = table.numbers("energy.potential"),
                            d = table.numbers("energy.defect");
  double largest = 0, growth = 0;
  for (size_t i = 0; i < t.size(); ++i) {
    kinetic = std::max(kinetic, t[i]);
    largest = std::max({largest, t[i], u[i], std::abs(t[i] + u[i] + v[i])});
    growth = std::max(growth, d[i]);
  }
  if (largest > 0) out.energy_growth = growth / largest;
}

Figures figures_of(const std::string& folder, const json& run, double& kinetic) {
  Figures out;
  const json motion = run.value("motion", json()), path = run.value("static", json());
  out.energy_defect = number(motion, "energy_defect");
  out.position_drift = number(motion, "constraint_drift");
  out.velocity_drift = number(motion, "velocity_drift");
  out.area_ratio = number(motion, "smallest_area_ratio");
  const auto worst = [&](const json& part) {
    if (const auto c = number(part, "condition"))
      out.condition = std::max(*c, out.condition.value_or(1));
  };
  worst(motion);
  worst(path);
  for (const json& body : run.value("results", json::array())) worst(body);
  out.rejected = number(motion.is_null() ? path : motion, "rejected_steps");
  const std::optional<double> newton =
                                  number(motion.is_null() ? path : motion, "newton_iterations"),
                              steps = motion.is_null() ? number(path, "equilibria")
                                                       : number(motion, "steps");
  if (newton && steps && *steps > 0) out.newton = *newton / *steps;
  read_energies(folder, out, kinetic);
  return out;
}

bool warns_of(const json& run, const std::string& word) {
  for (const json& warning : run.value("warnings", json::array()))
    if (warning.is_string() && warning.get<std::string>().find(word) != std::string::npos)
      return true;
  return false;
}

/// How a verdict comes about: the worst finding counts, of equals the first.
class Findings {
 public:
  void add(Verdict verdict, const std::string& reason) {
    if (verdict <= verdict_) return;
    verdict_ = verdict;
    reason_ = reason;
  }
  Verdict verdict() const { return verdict_; }
  const std::string& reason() const { return reason_; }

 private:
  Verdict verdict_ = Verdict::stable;
  std::string reason_;
};

/// What is only round-off of stresses is no energy: a share of nothing says nothing.
void forget_round_off(const Evidence& e, Figures& f) {
  if (!(quantity_in(e.folder, "energy.defect.largest").value_or(0) < e.bounds->rounding)) return;
  f.energy_defect.reset();
  f.energy_growth.reset();
}

void judge_energy(const Evidence& e, const json& run, const Figures& f, Findings& out) {
  const Bounds& b = *e.bounds;
  if (!f.energy_defect || *f.energy_defect <= b.defect()) return;
  const double growth = f.energy_growth.value_or(0);
  const bool grows = b.undriven && growth > b.defect();
  const double size = grows ? growth : *f.energy_defect;
  std::string words = (grows ? "energy grows by " : "energy defect ") + percent(size) + ", bound " +
                      percent(b.defect());
  if (b.h_omega() > kResolved)
    words += ": the step is too coarse, h omega = " + to_text(b.h_omega(), 2) + " for " + b.fastest;
  else
    words += ": as of motions with h omega = " + to_text(std::sqrt(size), 2) + ", " + b.fastest +
             " has " + to_text(b.h_omega(), 2);
  const bool silent = size > kLargestDefect && !warns_of(run, "energy");
  out.add(silent ? Verdict::wrong : Verdict::degraded,
          silent ? words + "; no warning says so" : words);
}

void judge_constraints(const Evidence& e, const Figures& f, double kinetic, Findings& out) {
  const Bounds& b = *e.bounds;
  if (f.position_drift && *f.position_drift > b.position())
    out.add(Verdict::wrong, "constraints are missed by " + to_text(*f.position_drift, 2) +
                                " m, bound " + to_text(b.position(), 2) + " m");
  if (f.velocity_drift && *f.velocity_drift > b.velocity(kinetic))
    out.add(Verdict::degraded,
            "velocities miss the constraints by " + to_text(*f.velocity_drift, 2) + " m/s, bound " +
                to_text(b.velocity(kinetic), 2) + " m/s: h omega = " + to_text(b.h_omega(), 2) +
                " for " + b.fastest);
}

/// What a run warns of first: "; the run warns: ..."; empty: nothing.
std::string warning_in(const json& run) {
  const json warnings = run.value("warnings", json::array());
  if (warnings.empty() || !warnings.front().is_string()) return "";
  return "; the run warns: " + warnings.front().get<std::string>();
}

void judge_invariances(const Evidence& e, const json& run, Findings& out) {
  for (const Invariance& law : e.row->invariances) {
    std::optional<double> wanted = law.value;
    if (!wanted && !e.reference.empty()) wanted = quantity_in(e.reference, law.quantity);
    if (!wanted) continue;  // the unperturbed run has failed, which is said there
    if (!law.value) *wanted *= law.factor;
    const std::optional<double> found = quantity_in(e.folder, law.quantity);
    const double allowed = std::max(law.absolute, law.relative * std::abs(*wanted));
    if (found && std::abs(*found - *wanted) <= allowed) continue;
    out.add(law.exact ? Verdict::wrong : Verdict::degraded,
            law.quantity + " = " + (found ? to_text(*found, 8) : "nothing") + ", not " +
                to_text(*wanted, 8) + ": " + law.why + (law.exact ? "" : warning_in(run)));
  }
}

void judge_finished(const Evidence& e, Judgement& out) {
  Findings findings;
  const json run = json::parse(text_of(e.folder + "/run.json"), nullptr, false);
  if (!run.is_object() || !run.value("status", "").starts_with("done")) {
    out.reason = "exit 0 without a run.json that is done";
    return;
  }
  if (run.value("status", "") != "done")
    findings.add(Verdict::degraded,
                 "the result is of no use, and the run says so" + warning_in(run));
  const bool moves = run.contains("motion") || run.contains("static");
  for (const auto& [key, table] : {std::pair("motion", "motion.csv"), {"static", "path.csv"}})
    if (run.contains(key) && text_of(e.folder + "/" + table).empty())
      findings.add(Verdict::wrong, std::string(table) + " is missing");
  if (!moves && (!run.contains("results") || run["results"].empty()))
    findings.add(Verdict::wrong, "exit 0 without a result");
  if (e.row->demand == Demand::refused) findings.add(Verdict::wrong, "is no scene and was run");
  double kinetic = 0;
  out.figures = figures_of(e.folder, run, kinetic);
  if (e.bounds && run.contains("motion")) {
    forget_round_off(e, out.figures);
    judge_constraints(e, out.figures, kinetic, findings);
    judge_energy(e, run, out.figures, findings);
  }
  if (out.figures.area_ratio && *out.figures.area_ratio <= 0)
    findings.add(Verdict::wrong, "material is turned inside out");
  judge_invariances(e, run, findings);
  for (const json& body : run.value("results", json::array())) {
    const double violation = number(body, "volume").value_or(0) - e.largest_volume;
    if (violation > 1e-3 && !warns_of(run, "volume"))
      findings.add(Verdict::wrong, "the volume is " + to_text(violation, 2) +
                                       " above what is allowed; no warning says so");
    else if (violation > 1e-3)
      findings.add(Verdict::degraded, "the volume that is allowed is not reached in " +
                                          to_text(number(body, "iterations").value_or(0), 4) +
                                          " iterations, and a warning says so");
  }
  out.verdict = findings.verdict();
  out.reason = findings.reason();
}

void judge_refused(const Evidence& e, Judgement& out) {
  const std::string message = last_words(e.words);
  out.reason = message;
  if (e.row->demand == Demand::runs)
    out.reason = "has to run: " + message;
  else if (!names_cause(e))
    out.reason = "refused without a cause: '" + message + "'";
  else
    out.verdict = Verdict::refused;
}

}  // namespace

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::stable:
      return "stable";
    case Verdict::refused:
      return "refused";
    case Verdict::degraded:
      return "degraded";
    case Verdict::wrong:
      break;
  }
  return "WRONG";
}

bool names_cause(const Evidence& e) {
  const std::string message = last_words(e.words);
  if (message.starts_with("--set ") || message.starts_with(e.path + ":")) return true;
  const json run = json::parse(text_of(e.folder + "/run.json"), nullptr, false);
  if (!run.is_object() || !run.contains("failure")) return false;
  const json& failure = run["failure"];
  const auto says = [&](const char* key) {
    return failure.contains(key) && failure[key].is_string() && !failure[key].empty() &&
           !failure[key].get<std::string>().empty();
  };
  return says("phase") && says("cause") && failure.value("kind", "") != "defect" &&
         (number(failure, "time") || number(failure, "load_factor") ||
          number(failure, "iteration"));
}

Judgement judge(const Evidence& e) {
  Judgement out;
  const Ending& end = e.ending;
  const std::string unreal = first_unreal(e.folder);
  if (end.over_time && end.signal == SIGKILL)
    out.reason = "hangs: did not end when it was asked to after " + to_text(end.seconds, 3) + " s";
  else if (end.signal != 0 && !(end.over_time && end.signal == SIGINT))
    out.reason = "ended by signal " + std::to_string(end.signal);
  else if (!unreal.empty())
    out.reason = unreal;
  else if (end.over_time && (end.signal != 0 || end.code == 4)) {
    out.verdict = Verdict::degraded;
    const std::optional<double> t = quantity_in(e.folder, "time");
    out.reason = "too slow for the time limit: " +
                 (t ? "at t = " + to_text(*t, 4) + " s" : std::string("not under way")) +
                 " after " + to_text(end.seconds, 3) + " s";
  } else if (end.code == 0 || end.code == kMissed)
    judge_finished(e, out);
  else if (end.code == 2 || end.code == 3)
    judge_refused(e, out);
  else
    out.reason = "exit code " + std::to_string(end.code) + ": " + last_words(e.words);
  return out;
}

}  // namespace flexmorph::cases
